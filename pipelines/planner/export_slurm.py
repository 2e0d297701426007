"""A set of Slurm jobs: arrays of steps, tied by afterok, or by aftercorr where task by task is enough, and submit.sh, which hands them in."""
import re
import shlex

from planner.errors import INVALID_CONTENT, PlanError
from planner.files import write_whole
from planner.graph import RETRIES, read_graph
from planner.slurm_arrays import arrays_of, slurm_log

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
refuse() {{ echo "$0: error: $*" >&2; exit 3; }}
exec 9>>run.lock
flock -n 9 || refuse {folder} "is at work already: plan run or submit.sh; wait for its end"
[ "$(head -n 1 plan.json)" = {head} ] || refuse {folder}/plan.json "changed since this was exported; export again"
if [ -e slurm-jobs.tsv ] && squeue -h --me -o %F | grep -qxF "$(cut -f1 slurm-jobs.tsv)"; then
    refuse "Slurm still has jobs of this run; wait for them, or take them back:" scancel $(cut -f1 slurm-jobs.tsv)
fi
list=slurm-jobs.tsv.$$
jobs=
note() {{ printf '%s\\t%s\\n' "$1" "$2" >>"$list"; jobs="$jobs${{jobs:+:}}$1"; }}
: >"$list"
touch run.lock  # now: what is recorded earlier is of an earlier run
# All or nothing: what was handed in before an error or a signal is taken back.
trap '[ -z "$jobs" ] || scancel $(echo "$jobs" | tr : " "); rm -f "$list"' EXIT
trap 'exit 130' INT
trap 'exit 143' TERM HUP
{submissions}
sbatch "$@" --parsable --dependency=afterany:"$jobs" {summary} >/dev/null
trap - EXIT
touch -r run.lock "$list"
mv "$list" slurm-jobs.tsv
echo "$jobs" | tr : '\\n'
"""


def export_slurm(graph, plan, folder, jobs_folder):
    """Writes the scripts and lists of tasks; each array task finds its step in line SLURM_ARRAY_TASK_ID of its list."""
    submissions = []
    for number, array in enumerate(arrays_of(graph), 1):
        script, tasks = write_job(graph, plan, folder, jobs_folder, array)
        name = f"job_{number}"
        submissions.append(f'{name}=$(sbatch "$@" --parsable {dependency(array)}{script})\n{name}=${{{name}%;*}}; note "${name}" {tasks}')
    summary = jobs_folder / "summary.sbatch"
    write_whole(summary, SUMMARY.format(plan=shlex.join(plan), **directives(folder, f"{graph.name}.summary", "")), executable=True)
    text = SUBMIT.format(name=graph.name, folder=shlex.quote(str(folder)), submissions="\n".join(submissions),
                         head=shlex.quote(read_graph(folder).partition("\n")[0]), summary=shlex.quote(str(summary)))  # fmt: skip
    write_whole(jobs_folder / "submit.sh", text, executable=True)


def directives(folder, name, task):
    """What #SBATCH lines say of a job, quoted as sbatch reads it."""
    if re.search(r'[\\"]', f"{folder}{name}"):
        raise PlanError(INVALID_CONTENT, f"{folder}: Slurm cannot have quotation marks and backslashes in names; rename it")
    log = slurm_log(folder, name).replace("%", "%%") + f"{task}.log"
    return {"name": f'"{name}"', "folder": f'"{folder}"', "log": f'"{log}"'}


def dependency(array):
    """An option of sbatch; the numbers of the jobs are in the shell's variables job_1 ..."""
    kinds = (("afterok", array.after_all), ("aftercorr", array.after_each))
    awaited = ",".join(":".join([kind, *(f"${{job_{i + 1}}}" for i in numbers)]) for kind, numbers in kinds if numbers)
    return f"--dependency={awaited} " if awaited else ""


def write_job(graph, plan, folder, jobs_folder, array):
    """Names of the job's script and of its list of tasks, quoted."""
    script, tasks = (jobs_folder / f"{array.name}{end}" for end in (".sbatch", ".tasks"))
    write_whole(tasks, "".join(f"{step.token}\n" for step in array.steps))
    needs = array.steps[0].resources
    gres = f"#SBATCH --gres=gpu:{needs['gpus']}\n" if needs["gpus"] else ""
    text = JOB.format(count=len(array.steps), plan=shlex.join(plan), gres=gres, tasks=shlex.quote(str(tasks)), retries=RETRIES,
                      **{key: needs[key] for key in ("cores", "memory", "minutes")},
                      **directives(folder, f"{graph.name}.{array.name}", "-%a"))  # fmt: skip
    write_whole(script, text, executable=True)
    return shlex.quote(str(script)), shlex.quote(str(tasks))
