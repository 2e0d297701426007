"""What Slurm says of the jobs that submit.sh noted."""
import json
import os
import subprocess

from planner.errors import FILE_ACCESS, INVALID_CONTENT, PlanError
from planner.files import read_text

JOBS = "slurm-jobs.tsv"  # job id, tasks file; written by submit.sh
TIMEOUT_SECONDS = 60


def time_of(path):
    """When a file was written, by the clock of the file system, which all nodes share; 0 if it is not there."""
    try:
        return os.stat(path).st_mtime_ns
    except FileNotFoundError:
        return 0


class SlurmSilent(PlanError):
    """Nobody knows what is queued."""


def queued_steps(folder):
    """{step id: (job, state, reason)}, say 12_3, PENDING, Resources, of what is queued or runs; None where nothing was submitted."""
    if not (folder / JOBS).exists():
        return None
    tasks, rows = {}, ask_squeue()
    queued = {job.partition("_")[0] for job, _, _ in rows}
    for line in read_text(folder / JOBS).splitlines():
        job, tab, file = line.partition("\t")
        if not tab:
            raise PlanError(INVALID_CONTENT, f"{folder / JOBS}: {json.dumps(line)} is none of submit.sh's jobs; submit again")
        for index, token in enumerate(read_text(folder / file).splitlines() if job in queued else (), 1):
            tasks[f"{job}_{index}"] = token.partition("@")[0]
    return {tasks[job]: (job, state, reason) for job, state, reason in rows if job in tasks}


def refuse_queued(folder):
    """Throws PlanError while Slurm has steps of this run: they read the files that are to be written."""
    try:
        queue = queued_steps(folder)
    except SlurmSilent as error:
        raise PlanError(FILE_ACCESS, f"{error}, or remove {folder / JOBS} if nothing of this run is queued") from None
    if queue:
        jobs = " ".join(sorted({job.partition("_")[0] for job, _, _ in queue.values()}, key=int))
        raise PlanError(FILE_ACCESS, f"{folder}: Slurm still has {len(queue)} steps of this run; wait for them, or take them back: scancel {jobs}")


def ask_squeue():
    """(job, state, reason or "") of each task."""
    command = ["squeue", "-h", "-r", "--me", "-o", "%i|%T|%r"]
    try:
        result = subprocess.run(command, capture_output=True, text=True, check=True, timeout=TIMEOUT_SECONDS)
    except (OSError, subprocess.SubprocessError) as error:
        said = str(getattr(error, "stderr", "") or error).strip()
        raise SlurmSilent(FILE_ACCESS, f"Slurm does not say what is queued: squeue: {json.dumps(said)}; try again") from None
    rows = (line.split("|", 2) for line in result.stdout.splitlines())
    return [(job, state, "" if reason == "None" else reason) for job, state, reason in rows]
