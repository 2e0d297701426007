"""The commands of pipelines/plan."""
import argparse
import json
import os
import pathlib
import signal
import subprocess
import sys
import time

from planner import export_make, export_ninja, export_openjd, export_slurm, junit, report, status
from planner.description import read_description
from planner.errors import FILE_ACCESS, SIGNALLED, USAGE, PlanError
from planner.files import passed_on, write_whole
from planner.graph import build_graph, load_graph, save_graph
from planner.run_step import run_step

PROGRAM = pathlib.Path(__file__).resolve().parent.parent / "plan"
NAME = pathlib.Path(sys.argv[0]).name  # plan, or rt-plan where it is installed
COMMANDS = ("run", "step", "status", "report")
EXIT_CODES = """
Other commands: %(name)s run|step|status|report --help

Exit codes:
  0   ok; status: all steps are done
  1   run, status: a step failed, so that the pipeline cannot be completed
  2   wrong usage
  3   a file could not be read or written
  4   invalid content in an input
  10  status: steps are running or waiting
  130 interrupted (Ctrl-C); 143 ended (SIGTERM)
step ends with the code of its tool
"""


def main(argv):
    try:
        command = argv[1] if len(argv) > 1 and argv[1] in COMMANDS else "export"
        options = parse(command, argv[1:] if command == "export" else argv[2:])
        return globals()[f"{command}_command"](options)
    except PlanError as error:
        print(f"{NAME}: error: {error}", file=sys.stderr)
        return error.exit_code
    except BrokenPipeError:
        return FILE_ACCESS
    except KeyboardInterrupt:
        print(f"{NAME}: error: interrupted", file=sys.stderr)
        return SIGNALLED + signal.SIGINT


def parse(command, words):
    name = NAME if command == "export" else f"{NAME} {command}"
    parser = argparse.ArgumentParser(prog=name, description=ABOUT[command], epilog=EXIT_CODES % {"name": NAME}, allow_abbrev=False,
                                     formatter_class=argparse.RawDescriptionHelpFormatter)  # fmt: skip
    if command in ("export", "run"):
        parser.add_argument("file", type=pathlib.Path, metavar="FILE", help="pipeline description, *.plan.json")
        parser.add_argument("-o", "--output", type=pathlib.Path, metavar="DIR", help="where everything goes; else a folder here, named like FILE")
        parser.add_argument("--tools", type=pathlib.Path, metavar="DIR", help="folder with rt-import and the others; else $RT_TOOLS_DIR, else they are looked for in PATH")  # fmt: skip
    else:
        parser.add_argument("folder", type=pathlib.Path, metavar="DIR", help="the run's folder")
    for words_of, settings in OPTIONS[command]:
        parser.add_argument(*words_of, **settings)
    return parser.parse_args(words)


PATH = {"type": pathlib.Path}
ABOUT = {
    "export": "Turns a pipeline description into steps: prints them, or writes them for an engine to run.",
    "run": "Runs the pipeline on this machine with Ninja, spread over the devices of RT_DEVICES, and says how it went.",
    "step": "Runs one step for an engine: waits for a device of RT_DEVICES, keeps a log and a record in DIR.",
    "status": "Says which steps are done, failed, running and waiting, and why; the summary of a run under any engine.",
    "report": "Writes one page of a run: pictures, times, comparisons, what was skipped and why.",
}
OPTIONS = {
    "export": [
        (["--dry-run"], {"action": "store_true", "help": "print the steps and write nothing; so does %(prog)s FILE alone"}),
        (["--json"], {"action": "store_true", "help": "print them as JSON"}),
        (["--ninja"], PATH | {"metavar": "FILE", "help": "write a build file for Ninja"}),
        (["--make"], PATH | {"metavar": "FILE", "help": "write a makefile for GNU Make"}),
        (["--slurm"], PATH | {"metavar": "DIR", "help": "write Slurm job arrays, and submit.sh, which hands them in"}),
        (["--openjd"], PATH | {"metavar": "FILE", "help": "write a job template of Open Job Description 2023-09"}),
    ],
    "run": [(["-j", "--jobs"], {"type": int, "metavar": "N", "help": "steps at a time; else Ninja decides"})],
    "step": [
        (["step"], {"metavar": "STEP", "help": "id of the step, or id@digest, which must be what DIR/plan.json says"}),
        (["--retries"], {"type": int, "default": 0, "metavar": "N", "help": "try again after crashes, lost GPUs and file access"}),
        (["--touch"], {"action": "store_true", "help": "give outputs that are up to date a new time stamp, as Make wants"}),
    ],
    "status": [(["--json"], {"action": "store_true", "help": "print all steps as JSON"})],
    "report": [
        (["-o", "--output"], PATH | {"metavar": "FILE", "help": "the page, HTML"}),
        (["--junit"], PATH | {"metavar": "FILE", "help": "steps as test cases, for CI"}),
    ],
}  # fmt: skip


def planned(options):
    """(graph, its run's folder)."""
    name = options.file.name.removesuffix(".json").removesuffix(".plan")
    folder = pathlib.Path(os.path.abspath(options.output or name))
    tools = options.tools or os.environ.get("RT_TOOLS_DIR")
    tools = pathlib.Path(os.path.abspath(tools)) if tools else None
    if tools and not (tools / "rt-trace").exists():
        raise PlanError(FILE_ACCESS, f"{tools}: there is no rt-trace in it; name the folder of the tools with --tools")
    description = read_description(options.file)
    return build_graph(description, name, pathlib.Path(os.path.abspath(options.file.parent)), folder, tools), folder


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
    save_graph(graph, folder)
    if ninja:
        write_whole(ninja, export_ninja.ninja_text(graph, plan, folder, ninja))
    if make:
        write_whole(make, export_make.make_text(graph, plan, folder, make))
    if slurm:
        export_slurm.export_slurm(graph, plan, folder, slurm)
    if openjd:
        write_whole(openjd, export_openjd.openjd_text(graph, plan, folder))
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
    graph, folder = planned(options)
    save_graph(graph, folder)
    file = folder / "build.ninja"
    write_whole(file, export_ninja.ninja_text(graph, [sys.executable, str(PROGRAM)], folder, file))
    write_whole(folder / "run.json", json.dumps({"start": time.time()}) + "\n")
    jobs = ["-j", str(options.jobs)] if options.jobs else []
    try:
        ninja = subprocess.Popen(["ninja", "-C", folder, "-k", "0", *jobs])
    except OSError as error:
        raise PlanError(FILE_ACCESS, f"ninja cannot be run: {error.strerror}; install ninja-build") from None
    with passed_on(ninja) as signals:
        ninja.wait()
    if signals:
        raise PlanError(SIGNALLED + signals[0], f"interrupted; steps that run have been ended, the same command goes on: {folder}")
    return print_status(graph, folder, as_json=False)


def step_command(options):
    return run_step(pathlib.Path(os.path.abspath(options.folder)), options.step, options.retries, options.touch)


def status_command(options):
    return print_status(load_graph(options.folder), options.folder, options.json)


def print_status(graph, folder, as_json):
    statuses = status.run_status(graph, folder)
    if as_json:
        print(json.dumps(status.as_json(graph, folder, statuses), indent=1))
    else:
        print(status.as_text(graph, folder, statuses), end="")
    return status.exit_code(statuses)


def report_command(options):
    if not options.output and not options.junit:
        raise PlanError(USAGE, "neither -o nor --junit: there is nothing to write")
    graph = load_graph(options.folder)
    statuses = status.run_status(graph, options.folder)
    if options.output:
        write_whole(options.output, report.page(graph, options.folder, statuses, options.output))
    if options.junit:
        write_whole(options.junit, junit.suite(graph, options.folder, statuses))
    return 0
