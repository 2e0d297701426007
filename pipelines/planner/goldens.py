"""Makes the goldens of a pipeline from the pictures of a run."""
import contextlib
import filecmp
import functools
import os
import pathlib

from planner.errors import FILE_ACCESS, INVALID_CONTENT, USAGE, PlanError
from planner.files import passed_on, replacement
from planner.freshness import untouched
from planner.run_step import read_record


def update_goldens(graph, folder):
    """What was done, in lines. Throws PlanError and replaces nothing if a picture is not there yet, or a copy cannot be made."""
    pictures = {}  # golden: picture
    for name, made in graph.comparisons.items():
        for item in made:
            if item["golden"] and pictures.setdefault(item["golden"], item["exr"]) != item["exr"]:
                raise PlanError(INVALID_CONTENT, f"$.comparisons.{name}.golden: is the golden of {pictures[item['golden']]} too; rename one")
    if not pictures:
        raise PlanError(USAGE, f"{folder}: no comparison has a golden; see the README of the pipelines")
    check_pictures(graph, folder, pictures)
    return replace_all([(folder / picture, golden_path(folder, golden)) for golden, picture in pictures.items()])


def golden_path(folder, golden):
    path = pathlib.Path(os.path.normpath(folder / golden))
    if path.suffix != ".exr":
        raise PlanError(INVALID_CONTENT, f"{path}: goldens that are made of renders end in .exr; rename it in the description")
    if path.is_dir():
        raise PlanError(FILE_ACCESS, f"{path}: is a folder; remove it, or name another golden")
    return path


def check_pictures(graph, folder, pictures):
    """All are whole, and of a run in which all went well that led to them."""
    makers = {picture["exr"]: picture["step"] for made in graph.renders.values() for picture in made}
    made = {output for step in graph.steps for output in step.outputs}
    record_of = functools.cache(lambda id: read_record(folder, graph.by_id[id]))
    is_done = functools.cache(lambda id: has_made(folder, record_of(id), made.intersection(graph.by_id[id].inputs)))
    for picture in pictures.values():
        ids = [step.id for step in graph.lineage(makers[picture])]
        failed = next((id for id in ids if record_of(id) and record_of(id)["state"] == "failed"), None)
        if failed:
            raise PlanError(FILE_ACCESS, f"{folder / picture}: is not of a finished run: {failed} failed; see {folder / graph.by_id[failed].log}, and run the pipeline again")
        undone = next((id for id in ids if not is_done(id)), None)
        if undone or not has_made(folder, record_of(makers[picture]), [picture]):
            since = f"{undone or makers[picture]} has not run since what it reads or makes changed"
            raise PlanError(FILE_ACCESS, f"{folder / picture}: is not of a finished run: {since}; run the pipeline")


def has_made(folder, record, files):
    """Whether it ended well, and these that it read or wrote are still the same."""
    return record and record["state"] in ("done", "skipped") and untouched(folder, record, files)


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
