"""Runs one step, for whatever engine asks for it: device, log, record, retries."""
import contextlib
import json
import os
import re
import signal
import socket
import subprocess
import time

from planner.devices import device
from planner.errors import CANNOT_RUN, FILE_ACCESS, INTERNAL, NO_GPU, SIGNALLED, USAGE, PlanError
from planner.files import open_lock, parse_json, printable, try_lock, write_whole
from planner.freshness import signatures
from planner.versions import REMEDY

# What a tool says of its failure is for those who read it: exit codes decide.
REASON = re.compile(r"^(rt-\w+: error: .*|limit: .*: broken|verdict: .*)$", re.MULTILINE)
STATES = ("running", "done", "skipped", "failed")
ATTEMPT = {"start": 0.0, "end": None, "host": "", "slot": "", "exitCode": None, "why": ""}
PAUSE_SECONDS = 0.5


def run_step(folder, step, running, version, retries=0, touch=False):
    """The attempts, of which the last counts. Outputs are there whole or, if its exit code is not 0, as they were before."""
    with step_lock(folder, step, running) as lock:
        attempts = interrupted_attempts(folder, step)
        for left in range(retries, -1, -1):
            attempt(folder, step, attempts, lock, running, version, touch)
            if left == 0 or running.signals or lacks_golden(folder, step) or not may_pass_next_time(attempts[-1]["exitCode"]):
                return attempts
            time.sleep(PAUSE_SECONDS)


def may_pass_next_time(code):
    """File access, a GPU that was not there, an internal error, a crash; not wrong input, and not being told to end."""
    return code in (FILE_ACCESS, NO_GPU, INTERNAL) or (code > SIGNALLED and code - SIGNALLED not in (signal.SIGTERM, signal.SIGINT))


def lacks_golden(folder, step):
    return step.stage == "compare" and not (folder / step.inputs[1]).exists()


def find_step(graph, folder, token):
    step = next((step for step in graph.steps if token in (step.id, step.token)), None)
    if step is None:
        raise PlanError(USAGE, f"{folder / 'plan.json'}: has no step {token}: it changed since this was exported; export again")
    return step


def refuse_blocked(graph, folder, step):
    """Throws PlanError if a step failed that led to it. For Slurm, which forgets that in arrays that are tied task by task."""
    for other in graph.lineage(step.id)[1:]:
        record = read_record(folder, other)
        if record and record["state"] == "failed":
            raise PlanError(FILE_ACCESS, f"{step.id}: is not run, since {other.id} failed; see {folder / other.log}")


def lock_path(folder, step):
    return folder / "steps" / f"{step.id}.lock"


@contextlib.contextmanager
def step_lock(folder, step, running):
    """Waits for another run of the same step, such as one whose node was believed dead."""
    handle = open_lock(lock_path(folder, step))
    try:
        running.wait_for(lambda: try_lock(handle))
        yield handle
    finally:
        os.close(handle)


def read_record(folder, step):
    """What the last run left, or None. A record of other options, or that is none of ours, does not count."""
    try:
        record = parse_json((folder / step.record).read_bytes())
        is_ours = record["token"] == step.token and record["state"] in STATES and isinstance(record.get("files", {}), dict)
        is_whole = all(map(is_attempt, record["attempts"])) and (record["state"] == "running" or has_ended(record["attempts"][-1]))
        return record if is_ours and record["attempts"] and is_whole else None
    except (FileNotFoundError, NotADirectoryError, ValueError, LookupError, TypeError, AttributeError):
        return None


def is_attempt(content):
    is_said = all(isinstance(content[key], str) for key in ("host", "slot", "why"))
    return is_said and is_time(content["start"]) and (has_ended(content) or content["end"] is None)


def has_ended(attempt):
    return isinstance(attempt["exitCode"], int) and is_time(attempt["end"])


def is_time(content):
    """Seconds since 1970, and not those of a damaged file."""
    return isinstance(content, (int, float)) and 0 <= content < 1e11


def interrupted_attempts(folder, step):
    """Attempts of a run that was cut off, which this one goes on from; else none."""
    record = read_record(folder, step)
    if record is None or record["state"] != "running":
        return []
    last = record["attempts"][-1]
    return record["attempts"][:-1] + [last | {"end": None, "why": "cut off"}]


def attempt(folder, step, attempts, lock, running, version, touch):
    with device(os.environ, running) if step.resources["gpus"] else contextlib.nullcontext(("", "", None)) as (slot, name, handle):
        current = ATTEMPT | {"start": time.time(), "host": socket.gethostname(), "slot": slot}
        attempts.append(current)
        save_record(folder, step, "running", attempts)
        prepare(folder, step)
        read, written = signatures(folder, step.inputs), signatures(folder, step.outputs)
        environment = os.environ | ({"RT_DEVICE": name} if name else {})
        handles = [fd for fd in (lock, handle) if fd is not None]
        code, said = execute(folder, step, environment, handles, len(attempts), running)
    code, state, why = verdict(folder, step, code, said, written == signatures(folder, step.outputs))
    for output in step.outputs if touch and code == 0 else ():
        os.utime(folder / output)
    current |= {"end": time.time(), "exitCode": code, "why": why}
    # An input that changed meanwhile has no signature. No clocks are compared: that of the file system may be another one.
    files = {file: now if read[file] == now else None for file, now in signatures(folder, step.inputs).items()} | signatures(folder, step.outputs)
    save_record(folder, step, state, attempts, {"version": version, "files": files} if code == 0 else {})


def prepare(folder, step):
    for output in step.outputs:
        (folder / output).parent.mkdir(parents=True, exist_ok=True)
    if step.stamp:
        (folder / step.stamp).unlink(missing_ok=True)


def execute(folder, step, environment, handles, number, running):
    """Exit code and output of the tool, which holds the locks too: they are free when it has ended, whoever dies first."""
    log = folder / step.log
    log.parent.mkdir(parents=True, exist_ok=True)
    with open(log, "a" if number > 1 else "w", encoding="utf-8", errors="replace") as file:
        file.write(f"# attempt {number}: {' '.join(step.argv)}\n")
        file.flush()
        begin = file.tell()
        try:
            process = subprocess.Popen(step.argv, cwd=folder, env=environment, stdin=subprocess.DEVNULL, stdout=file,
                                       stderr=file, pass_fds=handles)  # fmt: skip
        except OSError as error:
            said = f"{step.argv[0]}: error: cannot be run: {error.strerror}; {REMEDY}"
            file.write(said + "\n")
            return CANNOT_RUN, said
        code = running.wait(process)
    with open(log, encoding="utf-8", errors="replace") as file:
        file.seek(begin)
        return (code if code >= 0 else SIGNALLED - code), file.read()


def verdict(folder, step, code, said, is_same):
    """(exit code, state, why). `is_same`: the tool left all outputs as they were (--if-changed)."""
    if code == 0 and step.stamp:
        write_whole(folder / step.stamp, step.token + "\n", locked=True)
    missing = missing_outputs(folder, step)
    if code == 0 and missing:
        return INTERNAL, "failed", f"did not write {missing[0]}"
    if code == 0:
        return (0, "skipped", "up to date") if is_same else (0, "done", "")
    return code, "failed", printable(why_failed(folder, step, code, said))


def why_failed(folder, step, code, said):
    if code > SIGNALLED:
        limit = f" (Slurm's time limit of {step.resources['minutes']} min, or scancel?)"
        by_slurm = code - SIGNALLED == signal.SIGTERM and "SLURM_JOB_ID" in os.environ
        return f"ended by {signal_name(code - SIGNALLED)}" + (limit if by_slurm else "")
    if code == CANNOT_RUN:
        return said
    if lacks_golden(folder, step):
        return f"there is no golden {step.inputs[1]}: look at {step.inputs[0]}, then make goldens with update-goldens"
    reasons = REASON.findall(said)
    page = f"; see {step.outputs[1]}" if step.stage == "compare" and (folder / step.outputs[1]).exists() else ""
    return (reasons[0] if reasons else f"exit code {code}") + page


def missing_outputs(folder, step):
    return [output for output in step.outputs if not (folder / output).exists()]


def signal_name(number):
    try:
        return signal.Signals(number).name
    except ValueError:
        return f"signal {number}"


def save_record(folder, step, state, attempts, made=()):
    """`made`: the tool's version and the files' signatures, of a step that ended well."""
    content = {"id": step.id, "token": step.token, "state": state, "attempts": attempts, **dict(made)}
    write_whole(folder / step.record, json.dumps(content, indent=1) + "\n", locked=True)
