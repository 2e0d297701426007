"""Reads a pipeline description (*.plan.json): see plan.schema.json."""
import json
import pathlib
import re

from planner.errors import INVALID_CONTENT, PlanError
from planner.files import is_printable, parse_json, read_text
from planner.schema import first_fault
from planner.tool_options import DECIDED, faults_of_options, value_of

MOST_STEPS = 100_000  # of a graph with which Ninja, Make and status still work
TILE_ROWS = 32
SCHEMA = pathlib.Path(__file__).resolve().parent.parent / "plan.schema.json"


def read_description(path):
    """The checked content, whose names all lead somewhere. Throws PlanError with the JSON path of the first fault."""
    try:
        content = parse_json(read_text(path), object_pairs_hook=without_repeats)
    except ValueError as error:
        raise PlanError(INVALID_CONTENT, f"{path}: {error}") from None
    schema = json.loads(SCHEMA.read_text(encoding="utf-8"))
    fault = next(faults_of_characters(content, "$"), None) or first_fault(content, schema, schema)
    fault = fault or next(faults_of(content, path.parent), None)
    if fault:
        raise PlanError(INVALID_CONTENT, f"{path}: {fault[0]}: {fault[1]}")
    return content


def without_repeats(pairs):
    content = dict(pairs)
    if len(content) != len(pairs):
        names = [name for name, _ in pairs]
        raise ValueError(f"'{next(name for name in names if names.count(name) > 1)}' is there twice")
    return content


def faults_of_characters(content, place):
    """Those that no engine's file can hold in a name."""
    for text in content if isinstance(content, dict) else [content] if isinstance(content, str) else ():
        if not is_printable(text):
            yield place, f"{json.dumps(text)} has a control character or half a character; leave it out"
    if isinstance(content, dict):
        for key, member in content.items():
            yield from faults_of_characters(member, f"{place}.{key}")
    if isinstance(content, list):
        for i, member in enumerate(content):
            yield from faults_of_characters(member, f"{place}[{i}]")


def faults_of(content, folder):
    """What the schema cannot say."""
    yield from faults_of_names(content)
    for kind in DECIDED:
        for name, item in content.get(kind, {}).items():
            yield from faults_of_options(kind, f"$.{kind}.{name}", item)
    yield from faults_of_number(content)
    for name, render in content["renders"].items():
        yield from faults_of_render(f"$.renders.{name}", render)
    for name, comparison in content.get("comparisons", {}).items():
        yield from faults_of_comparison(f"$.comparisons.{name}", comparison, content["renders"])
    for place, file in files_of(content, "$"):
        if not (folder / file).exists():
            yield place, f"there is no file {folder / file}"


def faults_of_names(content):
    links = [("atlases", "scene", "scenes"), ("renders", "atlas", "atlases"), ("comparisons", "render", "renders"),
             ("comparisons", "against", "renders")]  # fmt: skip
    for kind, key, target in links:
        for name, item in content.get(kind, {}).items():
            if key in item and item[key] not in content[target]:
                there = ", ".join(content[target])
                yield f"$.{kind}.{name}.{key}", f"'{item[key]}' is none of $.{target}, which are {there}"


def faults_of_render(place, render):
    first, last = render.get("frames", (0, 0))
    if last < first:
        yield f"{place}.frames", f"the last, {last}, is before the first, {first}"
    if "frames" not in render and ("framesPerStep" in render or "cameraPath" in render):
        yield place, "framesPerStep and cameraPath need frames"
    moves = "camera" in render or "cameraPath" in render or value_of(render.get("options", []), "--turntable") is not None
    if "frames" in render and not moves:
        yield f"{place}.frames", "need a camera with a path, cameraPath, or the option --turntable"
    if render.get("shards", 1) > 1 and render.get("framesPerStep", 1) > 1:
        yield f"{place}.framesPerStep", "shards split a frame, framesPerStep joins frames: give one of them"
    if "shardBy" in render and render.get("shards", 1) == 1:
        yield f"{place}.shardBy", "needs shards, 2 or more"
    elif render.get("shards", 1) > 1:
        yield from faults_of_shards(place, render)


def faults_of_number(content):
    """Counts without making them; a picture counts as a step, though a step may make several."""
    total = len(content["scenes"]) + len(content["atlases"])
    for kind in ("renders", "comparisons"):
        for name, item in content.get(kind, {}).items():
            first, last = (item if kind == "renders" else content["renders"][item["render"]]).get("frames", (0, 0))
            shards = item.get("shards", 1)
            total += max(last - first + 1, 0) * (shards + 1 if shards > 1 else 1)
            if total > MOST_STEPS:
                yield f"$.{kind}.{name}", f"makes it {total} steps; {MOST_STEPS} at most: describe parts of the frames apart"


def faults_of_shards(place, render):
    """What rt-trace --shard refuses. Values that are no numbers are left to it."""
    options = render.get("options", [])
    if render.get("shardBy") == "samples":
        for name in ("--time-limit", "--target-error", "--heat"):
            if value_of(options, name) is not None:
                yield f"{place}.shardBy", f"samples does not go with {name}; take parts"
        most, of = whole_number(value_of(options, "--spp") or "1"), "samples per pixel (--spp)"
    else:
        corners = [whole_number(word) for word in (value_of(options, "--crop") or "").split(",")]
        first, end = corners[1::2] if len(corners) == 4 else (0, render.get("size", (512, 512))[1])
        most, of = None if None in (first, end) else -(-end // TILE_ROWS) - first // TILE_ROWS, f"rows of tiles of {TILE_ROWS} pixels"
    if most is not None and render["shards"] > most:
        yield f"{place}.shards", f"{render['shards']} are more than the picture's {most} {of}; lower them"


def whole_number(word):
    return int(word) if isinstance(word, str) and word.isdecimal() else None


def faults_of_comparison(place, comparison, renders):
    if ("against" in comparison) == ("golden" in comparison):
        yield place, "wants either 'against', a render, or 'golden', a picture"
        return
    if comparison["render"] == comparison.get("against"):
        yield f"{place}.against", f"'{comparison['render']}' would be compared with itself; name another render"
    frames = renders[comparison["render"]].get("frames")
    if "against" in comparison and renders[comparison["against"]].get("frames") != frames:
        yield f"{place}.against", f"has other frames than '{comparison['render']}'"
    is_sequence = re.search(r"%(0\d+)?d", comparison.get("golden", ""))
    if "golden" in comparison and bool(is_sequence) != bool(frames):
        yield f"{place}.golden", "wants a number like %04d in its name where there are frames, and only there"


def files_of(content, place):
    """(JSON path, name) of all input files but goldens, which may be made only after a first render."""
    if isinstance(content, list):
        for i, item in enumerate(content):
            yield from files_of(item, f"{place}[{i}]")
    if not isinstance(content, dict):
        return
    for key, item in content.items():
        if key in ("file", "cameraPath"):
            yield f"{place}.{key}", item
        elif key == "inputs":
            yield from ((f"{place}.inputs[{i}]", file) for i, file in enumerate(item))
        else:
            yield from files_of(item, f"{place}.{key}")
