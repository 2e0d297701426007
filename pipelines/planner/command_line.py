"""The commands of pipelines/plan."""
import json
import os
import pathlib
import signal
import sys
import time

from planner import VERSION, export_make, export_ninja, export_openjd, export_slurm, junit, report, status
from planner.description import read_description
from planner.errors import FILE_ACCESS, INVALID_CONTENT, SIGNALLED, USAGE, PlanError
from planner.files import is_printable, passed_on, write_whole
from planner.goldens import update_goldens
from planner.graph import build_graph, load_graph, save_graph
from planner.help_text import Parser, whole_number
from planner.report import RUN
from planner.run_here import RUN_LOCK, Scheduler, run_lock
from planner.run_step import find_step, refuse_blocked, run_step
from planner.slurm_queue import JOBS, SlurmSilent, queued_steps, refuse_queued
from planner.versions import check_programs, folder_of_tools, version_of, versions_of

PROGRAM = pathlib.Path(__file__).resolve().parent.parent / "plan"
NAME = pathlib.Path(sys.argv[0]).name  # plan, or rt-plan where it is installed
COMMANDS = {
    "run": "runs the steps here", "status": "says how far a run is", "report": "makes a page of it",
    "update-goldens": "takes its pictures for goldens", "step": "runs one step, for engines",
}  # fmt: skip
EXIT_CODES = """
Exit codes:
  0   ok; status: all steps are done
  1   run, status: a step failed, so that the pipeline cannot be completed
  2   wrong usage
  3   a file could not be read or written
  4   invalid content in an input
  10  run, status: steps are running or waiting
  130 interrupted (Ctrl-C); 143 ended (SIGTERM); step ends with the code of its tool
"""


def main(argv):
    try:
        command = argv[1] if len(argv) > 1 and argv[1] in COMMANDS else "export"
        options = parse(command, argv[1:] if command == "export" else argv[2:])
        code = FUNCTIONS[command](options)
        print(end="", flush=True)
        return code
    except PlanError as error:
        print(f"{NAME}: error: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        os.dup2(os.open(os.devnull, os.O_WRONLY), sys.stdout.fileno())  # for what Python still has to flush
        print(f"{NAME}: error: standard output: its reader has closed it", file=sys.stderr)
        return FILE_ACCESS
    except OSError as error:
        print(f"{NAME}: error: {error.filename or 'a file'}: {error.strerror}", file=sys.stderr)
        return FILE_ACCESS
    except KeyboardInterrupt:
        print(f"{NAME}: error: interrupted", file=sys.stderr)
        return SIGNALLED + signal.SIGINT


def parse(command, words):
    name = NAME if command == "export" else f"{NAME} {command}"
    about = ABOUT[command]
    if command == "export":
        about += "\nOther commands: " + ", ".join(f"{NAME} {other} --help ({does})" for other, does in COMMANDS.items()) + "."
    first = DESCRIPTION if command in ("export", "run") else FOLDER
    return Parser(name, about, first + OPTIONS[command] + GENERAL, EXIT_CODES).parse_args(words)


PATH = {"type": pathlib.Path}
DESCRIPTION = [
    (["file"], PATH | {"metavar": "FILE", "help": "pipeline description, *.plan.json"}),
    (["-o", "--output"], PATH | {"metavar": "DIR", "help": "where everything goes; else a folder here, named like FILE"}),
    (["--tools"], PATH | {"metavar": "DIR", "help": "folder with rt-import and the others; else $RT_TOOLS_DIR, else they are looked for in PATH, then beside this program"}),
]
FOLDER = [(["folder"], PATH | {"metavar": "DIR", "help": "the run's folder"})]
GENERAL = [
    (["-h", "--help"], {"action": "help", "help": "Print this help message and exit"}),
    (["--version"], {"action": "version", "version": f"{NAME} {VERSION}", "help": "Display program version information and exit"}),
]
ABOUT = {
    "export": "Turns a pipeline description into steps: prints them, or writes them for an engine to run.",
    "run": "Runs what is not up to date on this machine, spread over the devices of RT_DEVICES, and says how it went.",
    "step": "Runs one step for an engine: waits for a device of RT_DEVICES, keeps a log and a record in DIR.",
    "status": "Says which steps are done, failed, running and waiting, and why; the summary of a run under any engine.",
    "report": "Writes one page of a run: pictures, times, comparisons, what was skipped and why.",
    "update-goldens": "Copies the pictures of a finished run to where its description has the goldens; replaces none before all are copied.",
}
OPTIONS = {
    "export": [
        (["--dry-run"], {"action": "store_true", "help": "print the steps and write nothing; so does FILE alone"}),
        (["--json"], {"action": "store_true", "help": "print them as JSON"}),
        (["--ninja"], PATH | {"metavar": "FILE", "help": "write a build file for Ninja"}),
        (["--make"], PATH | {"metavar": "FILE", "help": "write a makefile for GNU Make"}),
        (["--slurm"], PATH | {"metavar": "DIR", "help": "write Slurm job arrays, and submit.sh, which hands them in"}),
        (["--openjd"], PATH | {"metavar": "FILE", "help": "write a job template of Open Job Description 2023-09"}),
    ],
    "run": [(["-j", "--jobs"], {"type": whole_number(1), "metavar": "N", "help": "steps at a time; else as many as there are devices, and cores for the others"})],
    "step": [
        (["step"], {"metavar": "STEP", "help": "id of the step, or id@digest, which must be what DIR/plan.json says"}),
        (["--retries"], {"type": whole_number(0), "default": 0, "metavar": "N", "help": "try again after crashes, lost GPUs and file access"}),
        (["--touch"], {"action": "store_true", "help": "give outputs that are up to date a new time stamp, as Make wants"}),
    ],
    "status": [(["--json"], {"action": "store_true", "help": "print all steps as JSON"})],
    "report": [
        (["-o", "--output"], PATH | {"metavar": "FILE", "help": "the page, HTML"}),
        (["--junit"], PATH | {"metavar": "FILE", "help": "steps as test cases, for CI"}),
    ],
    "update-goldens": [],
}  # fmt: skip


def planned(options, runs=False):
    """(graph, its run's folder). `runs`: the tools have to be here."""
    name = options.file.name.removesuffix(".json").removesuffix(".plan")
    if not name:
        raise PlanError(USAGE, f"{options.file}: has no name before .plan.json, after which the run is called; rename it")
    folder = real(options.output or name)
    if folder.exists() and not folder.is_dir():
        raise PlanError(FILE_ACCESS, f"{folder}: is no folder; name one for the run with -o")
    tools = folder_of_tools(options.tools)
    description = read_description(options.file)
    try:
        graph = build_graph(description, name, real(options.file.parent), folder, real(tools) if tools else None)
    except PlanError as error:
        raise PlanError(error.exit_code, f"{options.file}: {error}") from None
    if tools or runs:
        check_programs(graph)
    return graph, folder


def real(path):
    """Absolute and without links: tools run in the run's folder, from where .. leads to where it really is."""
    text = os.path.realpath(path)
    if not is_printable(text):
        raise PlanError(INVALID_CONTENT, f"{ascii(text)}: has a control character or is no UTF-8; rename it")
    return pathlib.Path(text)


def export_command(options):
    if (options.dry_run or options.json) and (options.ninja or options.make or options.slurm or options.openjd):
        said = "--dry-run" if options.dry_run else "--json"
        raise PlanError(USAGE, f"{said} prints steps; it does not go with --ninja, --make, --slurm and --openjd, which write them")
    graph, folder = planned(options)
    plan = [sys.executable, str(PROGRAM)]
    targets = [options.ninja, options.make, options.slurm, options.openjd]
    if not any(targets):
        print(steps_as_json(graph) if options.json else steps_as_text(graph, folder), end="")
        return 0
    ninja, make, slurm, openjd = (target and pathlib.Path(os.path.abspath(target)) for target in targets)
    with run_lock(folder):
        refuse_queued(folder)
        save_graph(graph, folder)
        (folder / RUN).unlink(missing_ok=True)
        if not slurm:  # which else has to run every step again
            (folder / JOBS).unlink(missing_ok=True)
    if ninja:
        write_whole(ninja, export_ninja.ninja_text(graph, plan, folder, ninja))
    if make:
        write_whole(make, export_make.make_text(graph, plan, folder, make))
    if slurm:
        export_slurm.export_slurm(graph, plan, folder, slurm)
    if openjd:
        write_whole(openjd, export_openjd.openjd_text(graph, plan, folder, openjd))
    return 0


def steps_as_text(graph, folder):
    lines = [f"{graph.name}: {len(graph.steps)} steps in {folder}"]
    for step in graph.steps:
        needs = step.resources
        gpu = f"{needs['gpus']} gpu, " if needs["gpus"] else ""
        lines.append(f"{step.id}: {gpu}{needs['cores']} cores, {needs['memory']} MiB, {needs['minutes']} min")
        lines.append(f"    {' '.join(step.argv)}")
        lines.append(f"    makes {' '.join(step.outputs)}" + (f"; after {' '.join(step.depends_on)}" if step.depends_on else ""))
    return "\n".join(lines) + "\n"


def steps_as_json(graph):
    keys = ("id", "group", "argv", "inputs", "outputs", "depends_on", "resources")
    steps = [{("dependsOn" if key == "depends_on" else key): getattr(step, key) for key in keys} for step in graph.steps]
    return json.dumps({"name": graph.name, "steps": steps}, indent=1) + "\n"


def run_command(options):
    graph, folder = planned(options, runs=True)
    versions = versions_of(graph)
    with run_lock(folder), passed_on() as running:
        refuse_queued(folder)
        save_graph(graph, folder)
        write_whole(folder / RUN, json.dumps({"start": time.time()}) + "\n")
        (folder / JOBS).unlink(missing_ok=True)
        Scheduler(graph, folder, versions, running, options.jobs).run()
    if running.signals:
        raise PlanError(SIGNALLED + running.signals[0], f"interrupted; steps that ran have been ended, the same command goes on: {folder}")
    return print_status(graph, folder, as_json=False)


def step_command(options):
    folder = pathlib.Path(os.path.abspath(options.folder))
    graph = load_graph(folder)
    step = find_step(graph, folder, options.step)
    if "SLURM_ARRAY_TASK_ID" in os.environ:
        refuse_blocked(graph, folder, step)
    with passed_on() as running:
        last = run_step(folder, step, running, version_of(step.argv[0]), options.retries, options.touch)[-1]
    if last["exitCode"]:
        print(f"{NAME}: error: {step.id}: {last['why']}  [{folder / step.log}]", file=sys.stderr)
    return last["exitCode"]


def status_command(options):
    return print_status(load_graph(options.folder), options.folder, options.json)


def statuses_of(graph, folder):
    """By the records alone where Slurm does not answer."""
    try:
        queue = queued_steps(folder)
    except SlurmSilent as error:
        print(f"{NAME}: warning: {error}", file=sys.stderr)
        return status.run_status(graph, folder, None, is_silent=True)
    return status.run_status(graph, folder, queue)


def print_status(graph, folder, as_json):
    statuses = statuses_of(graph, folder)
    if as_json:
        print(json.dumps(status.as_json(graph, folder, statuses), indent=1))
    else:
        print(status.as_text(graph, folder, statuses), end="")
    return status.exit_code(statuses)


def report_command(options):
    if not options.output and not options.junit:
        raise PlanError(USAGE, "neither -o nor --junit: there is nothing to write")
    graph = load_graph(options.folder)
    for target in filter(None, (options.output, options.junit)):
        refuse_own(graph, options.folder, target)
    statuses = statuses_of(graph, options.folder)
    if options.output:
        write_whole(options.output, report.page(graph, options.folder, statuses, options.output))
    if options.junit:
        write_whole(options.junit, junit.suite(graph, options.folder, statuses))
    return 0


def refuse_own(graph, folder, target):
    """Throws PlanError if a report would replace a file of the run, or of its sources."""
    own = {file for step in graph.steps for file in (*step.inputs, *step.outputs, step.record, step.log)} | {"plan.json", RUN, RUN_LOCK, JOBS}
    if os.path.relpath(real(target), real(folder)) in own:
        raise PlanError(USAGE, f"{target}: belongs to the run; name another file for the report")


def update_goldens_command(options):
    folder = real(options.folder)
    graph = load_graph(folder)
    with run_lock(folder):
        print("\n".join(update_goldens(graph, folder, statuses_of(graph, folder))))
    return 0


FUNCTIONS = {
    "export": export_command, "run": run_command, "status": status_command, "report": report_command,
    "update-goldens": update_goldens_command, "step": step_command,
}  # fmt: skip
