"""A set of Slurm jobs: an array for each group of steps, tied by afterok, and submit.sh, which hands them in."""
import re
import shlex

from planner.errors import INVALID_CONTENT, PlanError
from planner.files import write_whole
from planner.graph import RETRIES

JOB = """#!/bin/sh
#SBATCH --job-name={name}
#SBATCH --array=1-{count}
#SBATCH --chdir={folder}
#SBATCH --output={log}
#SBATCH --open-mode=append
#SBATCH --requeue
#SBATCH --kill-on-invalid-dep=yes
#SBATCH --cpus-per-task={cores}
#SBATCH --mem={memory}M
#SBATCH --time={minutes}
{gres}exec {plan} step . "$(sed -n "${{SLURM_ARRAY_TASK_ID}}p" {tasks})" --retries {retries}
"""

SUMMARY = """#!/bin/sh
#SBATCH --job-name={name}
#SBATCH --chdir={folder}
#SBATCH --output={log}
#SBATCH --requeue
#SBATCH --time=10
{plan} status . >summary.txt
{plan} report . -o report.html --junit junit.xml
"""

SUBMIT = """#!/bin/sh
# Hands the jobs of {name} in; options given here go to every sbatch, say --partition=gpu.
set -eu
cd {folder}
mkdir -p logs
list=slurm-jobs.tsv.$$
if [ -e slurm-jobs.tsv ] && squeue -h --me -o %F | grep -qxF "$(cut -f1 slurm-jobs.tsv)"; then
    echo "$0: error: Slurm still has jobs of this run; wait for them, or take them back:" scancel $(cut -f1 slurm-jobs.tsv) >&2
    exit 3
fi
jobs=
note() {{ printf '%s\\t%s\\n' "$1" "$2" >>"$list"; jobs="$jobs${{jobs:+:}}$1"; }}
: >"$list"
# All or nothing: what was handed in before an error or a signal is taken back.
trap '[ -z "$jobs" ] || scancel $(echo "$jobs" | tr : " "); rm -f "$list"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
{submissions}
sbatch "$@" --parsable --dependency=afterany:"$jobs" {summary} >/dev/null
trap - EXIT
mv "$list" slurm-jobs.tsv
echo "$jobs" | tr : '\\n'
"""


def export_slurm(graph, plan, folder, jobs_folder):
    """Writes the scripts and lists of tasks; each array task finds its step in line SLURM_ARRAY_TASK_ID of its list."""
    chunks = graph.chunks()
    dependencies = graph.group_dependencies()
    submissions = []
    variables = {}  # group: the shell's variables that hold its jobs
    for group, parts in chunks.items():
        awaited = [f"${{{name}}}" for other in dependencies[group] for name in variables[other]]
        variables[group] = [f"job_{len(submissions) + i + 1}" for i in range(len(parts))]
        for i, (steps, name) in enumerate(zip(parts, variables[group])):
            script, tasks = write_job(graph, plan, folder, jobs_folder, group, i, steps)
            after = f"--dependency=afterok:{':'.join(awaited)} " if awaited else ""
            submissions.append(f'{name}=$(sbatch "$@" --parsable {after}{script})\n{name}=${{{name}%;*}}; note "${name}" {tasks}')
    summary = jobs_folder / "summary.sbatch"
    write_whole(summary, SUMMARY.format(plan=shlex.join(plan), **directives(folder, f"{graph.name}.summary", "")), executable=True)
    text = SUBMIT.format(name=graph.name, folder=shlex.quote(str(folder)), submissions="\n".join(submissions),
                         summary=shlex.quote(str(summary)))  # fmt: skip
    write_whole(jobs_folder / "submit.sh", text, executable=True)


def directives(folder, name, task):
    """What #SBATCH lines say of a job, quoted as sbatch reads it."""
    if re.search(r'[\\"]', f"{folder}{name}"):
        raise PlanError(INVALID_CONTENT, f"{folder}: Slurm cannot have quotation marks and backslashes in names; rename it")
    log = f"{folder}/logs/slurm-{name}".replace("%", "%%") + f"{task}.log"
    return {"name": f'"{name}"', "folder": f'"{folder}"', "log": f'"{log}"'}


def write_job(graph, plan, folder, jobs_folder, group, i, steps):
    """Names of the job's script and of its list of tasks, quoted."""
    stem = jobs_folder / (group + (f".{i + 1}" if i else ""))
    tasks = stem.with_name(stem.name + ".tasks")
    write_whole(tasks, "".join(f"{step.token}\n" for step in steps))
    needs = steps[0].resources
    gres = f"#SBATCH --gres=gpu:{needs['gpus']}\n" if needs["gpus"] else ""
    text = JOB.format(count=len(steps), plan=shlex.join(plan), gres=gres, tasks=shlex.quote(str(tasks)), retries=RETRIES,
                      **{key: needs[key] for key in ("cores", "memory", "minutes")},
                      **directives(folder, f"{graph.name}.{stem.name}", "-%a"))  # fmt: skip
    script = stem.with_name(stem.name + ".sbatch")
    write_whole(script, text, executable=True)
    return shlex.quote(str(script)), shlex.quote(str(tasks))
