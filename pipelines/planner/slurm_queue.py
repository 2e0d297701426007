"""What Slurm says of the jobs that submit.sh noted."""
import json
import subprocess

from planner.errors import FILE_ACCESS, INVALID_CONTENT, PlanError
from planner.files import read_text

JOBS = "slurm-jobs.tsv"  # job id, tasks file; written by submit.sh
TIMEOUT_SECONDS = 60


class SlurmSilent(PlanError):
    """Nobody knows what is queued."""


def queued_steps(folder):
    """{step id: (job, state, reason)}, say 12_3, PENDING, Resources, of what is queued or runs; None where nothing was submitted."""
    if not (folder / JOBS).exists():
        return None
    tasks = {}
    for line in read_text(folder / JOBS).splitlines():
        job, tab, file = line.partition("\t")
        if not tab:
            raise PlanError(INVALID_CONTENT, f"{folder / JOBS}: {json.dumps(line)} is none of submit.sh's jobs; submit again")
        for index, token in enumerate(read_text(folder / file).splitlines(), 1):
            tasks[f"{job}_{index}"] = token.partition("@")[0]
    return {tasks[job]: (job, state, reason) for job, state, reason in ask_squeue() if job in tasks}


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
