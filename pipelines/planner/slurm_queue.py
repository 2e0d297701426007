"""What Slurm says of the jobs that submit.sh noted."""
import json
import subprocess

from planner.errors import FILE_ACCESS, PlanError
from planner.files import read_text

JOBS = "slurm-jobs.tsv"  # job id, tasks file; written by submit.sh


def queued_steps(folder):
    """{step id: "12_3 PENDING (Resources)"} of what is queued or runs; None where nothing was submitted."""
    if not (folder / JOBS).exists():
        return None
    tasks = {}
    for line in read_text(folder / JOBS).splitlines():
        job, file = line.split("\t")
        for index, token in enumerate(read_text(folder / file).splitlines(), 1):
            tasks[f"{job}_{index}"] = token.partition("@")[0]
    return {tasks[task]: text for task, text in ask_squeue().items() if task in tasks}


def ask_squeue():
    """{task: its id, state and reason}."""
    try:
        result = subprocess.run(["squeue", "-h", "-r", "--me", "-o", "%i|%T|%r"], capture_output=True, text=True, check=True)
    except (OSError, subprocess.CalledProcessError) as error:
        said = (getattr(error, "stderr", "") or str(error)).strip()
        raise PlanError(FILE_ACCESS, f"Slurm does not say what is queued: squeue: {json.dumps(said)}; try again") from None
    rows = (line.split("|", 2) for line in result.stdout.splitlines())
    return {task: f"{task} {state}" + ("" if reason == "None" else f" ({reason})") for task, state, reason in rows}
