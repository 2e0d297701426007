"""Makes the goldens of a pipeline from the pictures of a run."""
import contextlib
import filecmp
import os
import pathlib

from planner.errors import FILE_ACCESS, INVALID_CONTENT, USAGE, PlanError
from planner.files import passed_on, replacement
from planner.status import DONE


def update_goldens(graph, folder, statuses):
    """What was done, in lines. Throws PlanError and replaces nothing if a picture is not there yet, or a copy cannot be made."""
    pictures = {}  # golden: picture
    for name, made in graph.comparisons.items():
        for item in made:
            if item["golden"] and pictures.setdefault(item["golden"], item["exr"]) != item["exr"]:
                raise PlanError(INVALID_CONTENT, f"$.comparisons.{name}.golden: is the golden of {pictures[item['golden']]} too; rename one")
    if not pictures:
        raise PlanError(USAGE, f"{folder}: no comparison has a golden; see the README of the pipelines")
    check_pictures(graph, folder, pictures, statuses)
    return replace_all([(folder / picture, golden_path(folder, golden)) for golden, picture in pictures.items()])


def golden_path(folder, golden):
    path = pathlib.Path(os.path.normpath(folder / golden))
    if path.suffix != ".exr":
        raise PlanError(INVALID_CONTENT, f"{path}: goldens that are made of renders end in .exr; rename it in the description")
    if path.is_dir():
        raise PlanError(FILE_ACCESS, f"{path}: is a folder; remove it, or name another golden")
    return path


def check_pictures(graph, folder, pictures, statuses):
    """All are whole, and of a run in which all went well that led to them."""
    makers = {picture["exr"]: picture["step"] for made in graph.renders.values() for picture in made}
    by_id = {status.step.id: status for status in statuses}
    for picture in pictures.values():
        lineage = [by_id[step.id] for step in graph.lineage(makers[picture])]
        undone = next((status for status in reversed(lineage) if status.state not in DONE), None)
        if undone:
            said = f"{undone.step.id} {undone.state} ({undone.why})" if undone.why else f"{undone.step.id} {undone.state}"
            raise PlanError(FILE_ACCESS, f"{folder / picture}: is not of a finished run: {said}; see plan status {folder}")


def replace_all(pairs):
    """Copies all before it replaces the first; a signal that comes after that is too late."""
    changed = {target: "replaced" if target.exists() else "new" for source, target in pairs if not is_same(source, target)}
    with passed_on() as running, contextlib.ExitStack() as copies:
        ready = [copies.enter_context(replacement(target, source.read_bytes())) for source, target in pairs if target in changed]
        running.check()
        for replace in ready:
            replace()
    return [f"{target}: {changed.get(target, 'the same')}" for _, target in pairs]


def is_same(source, target):
    return target.exists() and filecmp.cmp(source, target, shallow=False)
