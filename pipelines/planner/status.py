"""How far a run is: what is done, failed, running and waiting, and why."""
import collections
import dataclasses
import fcntl
import os

from planner.files import try_lock
from planner.freshness import untouched
from planner.run_here import RUN_LOCK
from planner.run_step import lock_path, missing_outputs, read_record
from planner.slurm_arrays import arrays_of, slurm_log
from planner.slurm_queue import JOBS, time_of

FINISHED, FAILED, UNFINISHED = 0, 1, 10
DONE = ("done", "skipped")
STATES = (*DONE, "failed", "running", "waiting", "blocked")
AGAIN = "run the pipeline again: what is done is not done again"  # with plan run, submit.sh, ninja or make
LOST = "is not in Slurm's queue: cancelled, or lost"
UNKNOWN = "?"


@dataclasses.dataclass
class StepStatus:
    step: object
    state: str  # one of STATES
    why: str
    attempts: list
    job: str = ""  # of Slurm, that waits; UNKNOWN where Slurm does not answer
    reason: str = ""  # why Slurm lets it wait


def run_status(graph, folder, queue=None, is_silent=False):
    """The status of every step, in the graph's order. `queue`: that of Slurm, or None; `is_silent`: Slurm does not say it."""
    found, since = {}, time_of(folder / JOBS)
    for step in graph.steps:
        found[step.id] = step_status(step, folder, found, queue, is_silent, since)
    if queue is not None:
        say_why_lost(graph, folder, found, since)
    return list(found.values())


def say_why_lost(graph, folder, found, since):
    """What ended without a record has a log of Slurm's; else Slurm cancels an array if any step of another fails that it waited for as a whole."""
    arrays = arrays_of(graph)
    for array in arrays:
        awaited = (found[step.id] for number in array.after_all for step in arrays[number].steps)
        culprit = next((status for status in awaited if status.state in ("failed", "blocked")), None)
        for place, status in enumerate((found[step.id] for step in array.steps), 1):
            log = f"{slurm_log(folder, f'{graph.name}.{array.name}')}-{place}.log"
            if status.why == LOST and time_of(log) >= max(since, 1):
                status.why = f"ended before it could say why; see {log}"
            elif status.why == LOST and culprit:
                status.why = f"{culprit.step.id} {culprit.state}, and Slurm starts {status.step.group} after all of {culprit.step.group} only"


def step_status(step, folder, found, queue, is_silent, since):
    """`since`: when all steps were handed in to Slurm, so that what is recorded before is of an earlier run."""
    record, runs = record_of_now(folder, step)
    attempts = record["attempts"] if record else []
    if runs:
        return StepStatus(step, "running", place_of(attempts), attempts)
    if queue and step.id in queue:
        job, state, reason = queue[step.id]
        return StepStatus(step, "waiting", f"Slurm job {job} {state}" + (f" ({reason})" if reason else ""), attempts, job, reason)
    stopped = next((id for id in step.depends_on if found[id].state in ("failed", "blocked")), None)
    if stopped:
        older = "; its outputs are of an earlier run" if record and record["state"] in DONE else ""
        return StepStatus(step, "blocked", f"{stopped} {found[stopped].state}{older}", attempts)
    if record and time_of(folder / step.record) < since:
        record = None
    awaited = next((f"for {id}" for id in step.depends_on if found[id].state not in DONE), "")
    if record and record["state"] in DONE:
        changed = awaited or what_changed(folder, step, record, found)
        if changed:  # Slurm has nothing that would make it again.
            return StepStatus(step, "waiting" if queue is None or awaited else "blocked", changed, attempts)
    if record and record["state"] != "running":
        return StepStatus(step, record["state"], attempts[-1]["why"], attempts)
    if is_silent:
        return StepStatus(step, "waiting", "Slurm does not say whether it is queued", attempts, UNKNOWN)
    if record:
        return StepStatus(step, "failed", "cut off: its process ended without a word", attempts)
    if queue is not None:
        return StepStatus(step, "blocked", LOST, attempts)
    return StepStatus(step, "waiting", awaited or "to be started", attempts)


def what_changed(folder, step, record, found):
    """Since the step ended well; or "". Sources may be edited: nobody but the tools knows all of them."""
    gone = missing_outputs(folder, step)
    if gone:
        return f"{gone[0]} is gone"
    made = {output for id in step.depends_on for output in found[id].step.outputs}
    return "" if untouched(folder, record, [*made.intersection(step.inputs), *step.outputs]) else "what it reads or made has changed since"


def record_of_now(folder, step):
    """The record, or None, and whether the step runs. One that says so, though nothing runs, may have ended since it was read."""
    while True:
        record = read_record(folder, step)
        runs = is_running(folder, step)
        if runs or not record or record["state"] != "running" or record == read_record(folder, step):
            return record, runs


def is_running(folder, step):
    return is_held(lock_path(folder, step))


def is_held(lock):
    try:
        handle = os.open(lock, os.O_RDONLY)  # a folder that may only be read has a status too
    except FileNotFoundError:
        return False
    try:
        return not try_lock(handle, fcntl.LOCK_SH)
    finally:
        os.close(handle)


def place_of(attempts):
    return f"on {attempts[-1]['host']} {attempts[-1]['slot']}".rstrip() if attempts else ""


def exit_code(statuses):
    states = {status.state for status in statuses}
    return FAILED if states & {"failed", "blocked"} else UNFINISHED if states & {"running", "waiting"} else FINISHED


def as_text(graph, folder, statuses):
    """A line for each step that is not done, the counts, and what to do."""
    lines = [
        f"{s.state:8} {s.step.id:32} {s.why}" + (f"  [{folder / s.step.log}]" if s.state in ("failed", "running") else "")
        for s in statuses
        if s.state not in DONE
    ]
    counts = collections.Counter(status.state for status in statuses)
    total = ", ".join(f"{counts[state]} {state}" for state in STATES if counts[state])
    lines = [line.rstrip() for line in lines] + [f"{graph.name}: {len(statuses)} steps: {total}"]
    return "\n".join(lines + [f"next: {step}" for step in next_steps(counts, statuses, is_held(folder / RUN_LOCK))]) + "\n"


def next_steps(counts, statuses, is_at_work):
    held = [s.job for s in statuses if "held" in s.reason.lower()]
    queued = [s for s in statuses if s.job]
    reasons = "; ".join(sorted({s.reason for s in queued} - {"", "Dependency"}))
    if held:
        release = f"scontrol release {' '.join(held[:5])}"
        yield f"Slurm holds {len(held)} steps: scontrol update nodename=NODE state=resume where a node is drained, then {release}"
    elif any(s.job == UNKNOWN for s in queued):
        yield "ask again where Slurm answers"
    elif counts["failed"]:
        rest = "when the rest has ended, " if queued or counts["running"] or is_at_work else ""
        yield f"see the logs of what failed, mend it, and {rest}{AGAIN}"
    elif queued and not counts["running"]:
        yield f"wait for Slurm, which has {len(queued)} steps in its queue" + (f" ({reasons})" if reasons else "")
    elif counts["blocked"] + counts["waiting"] and not counts["running"] + is_at_work:
        yield AGAIN if counts["blocked"] else f"if no engine is at work, {AGAIN}"


def as_json(graph, folder, statuses):
    return {
        "name": graph.name,
        "steps": [
            {"id": s.step.id, "state": s.state, "why": s.why, "log": str(folder / s.step.log), "attempts": s.attempts}
            for s in statuses
        ],
    }
