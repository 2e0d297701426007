"""Where the tools are, and of which version."""
import os
import pathlib
import shutil
import subprocess
import sys

from planner.errors import FILE_ACCESS, PlanError

REMEDY = "name the folder of the tools with --tools DIR or $RT_TOOLS_DIR, or put them into PATH"
TIMEOUT_SECONDS = 60


def folder_of_tools(named):
    """Where they are, or None where PATH has them, or nothing; an installed rt-plan has them beside itself."""
    beside = pathlib.Path(sys.argv[0]).absolute().parent
    named = named or os.environ.get("RT_TOOLS_DIR")
    if named or shutil.which("rt-import"):
        return named
    return beside if (beside / "rt-import").exists() else None


def version_of(program):
    """What --version prints; the libraries count too. Nothing if it cannot be run, which its step will say."""
    try:
        return subprocess.run([program, "--version"], capture_output=True, text=True, errors="replace", timeout=TIMEOUT_SECONDS).stdout
    except OSError:
        return ""
    except subprocess.TimeoutExpired:
        raise PlanError(FILE_ACCESS, f"{program}: does not answer --version within {TIMEOUT_SECONDS} s; try it by hand") from None


def programs_of(graph):
    return sorted({step.argv[0] for step in graph.steps})


def versions_of(graph):
    """{program: its version}."""
    return {program: version_of(program) for program in programs_of(graph)}


def check_programs(graph):
    """Throws PlanError if one is not there."""
    missing = [program for program in programs_of(graph) if not shutil.which(program)]
    if missing:
        place = os.path.dirname(missing[0]) or "PATH"
        names = ", ".join(map(os.path.basename, missing))
        raise PlanError(FILE_ACCESS, f"{place}: there is no {names} in it; {REMEDY}")
