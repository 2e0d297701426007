"""Where the tools are, and of which version."""
import os
import shutil
import subprocess

from planner.errors import FILE_ACCESS, PlanError

REMEDY = "name the folder of the tools with --tools DIR or $RT_TOOLS_DIR, or put them into PATH"


def version_of(program):
    """What --version prints; the libraries count too. Nothing if it cannot be run, which its step will say."""
    try:
        return subprocess.run([program, "--version"], capture_output=True, text=True, errors="replace").stdout
    except OSError:
        return ""


def versions_of(graph):
    """{program: its version}. Throws PlanError if one is not there."""
    programs = sorted({step.argv[0] for step in graph.steps})
    check_programs(programs)
    return {program: version_of(program) for program in programs}


def check_programs(programs):
    missing = [program for program in programs if not shutil.which(program)]
    if missing:
        place = os.path.dirname(missing[0]) or "PATH"
        names = ", ".join(map(os.path.basename, missing))
        raise PlanError(FILE_ACCESS, f"{place}: there is no {names} in it; {REMEDY}")
