"""From a description to steps: what each runs, reads, writes, waits for and needs. Paths are relative to the run's folder."""
import dataclasses
import functools
import hashlib
import json
import os
import pathlib
import re

from planner.errors import FILE_ACCESS, INVALID_CONTENT, PlanError
from planner.files import read_text, write_whole

VERSION = 2
CHUNK = 1000  # Slurm's arrays end at 1000 where nobody changed MaxArraySize, Open Job Description's ranges at 1024
RETRIES = 2  # of a step, where Slurm or Open Job Description runs it
RESOURCES = {
    "import": {"gpus": 0, "cores": 2, "memory": 4096, "minutes": 30},
    "grid": {"gpus": 0, "cores": 4, "memory": 8192, "minutes": 60},
    "trace": {"gpus": 1, "cores": 2, "memory": 4096, "minutes": 120},
    "merge": {"gpus": 0, "cores": 1, "memory": 2048, "minutes": 10},
    "compare": {"gpus": 0, "cores": 2, "memory": 4096, "minutes": 30},
}


@dataclasses.dataclass(frozen=True)
class Step:
    """One call of a tool. Steps of a group differ in frame and shard only: engines make an array of them."""

    id: str
    stage: str
    group: str
    argv: list
    inputs: list  # files of the pipeline and sources
    outputs: list
    depends_on: list  # ids
    resources: dict
    depfile: str = ""
    stamp: str = ""  # an output that the runner makes when the tool ended well

    @property
    def token(self):
        """Names the step and what it ran when it was exported, but not where the tool was."""
        words = [os.path.basename(self.argv[0]), *self.argv[1:]]
        return f"{self.id}@{hashlib.sha256(json.dumps(words).encode()).hexdigest()[:8]}"

    @property
    def log(self):
        return f"logs/{self.id}.log"

    @property
    def record(self):
        return f"steps/{self.id}.json"


@dataclasses.dataclass(frozen=True)
class Graph:
    name: str
    steps: list  # each after those that it depends on
    renders: dict  # name: [{"exr", "step"}]
    comparisons: dict  # name: [{"step", "page", "figures", "exr", "golden"}]

    def groups(self):
        """{name: steps}, in order."""
        groups = {}
        for step in self.steps:
            groups.setdefault(step.group, []).append(step)
        return groups

    @functools.cached_property
    def by_id(self):
        return {step.id: step for step in self.steps}

    def lineage(self, id):
        """The step and all that it depends on, the nearest first."""
        ids = [id]
        for id in ids:
            ids += [other for other in self.by_id[id].depends_on if other not in ids]
        return [self.by_id[id] for id in ids]

    def sources(self):
        """Inputs that no step makes."""
        made = {output for step in self.steps for output in step.outputs}
        return sorted({file for step in self.steps for file in step.inputs} - made)


def graph_path(folder):
    return folder / "plan.json"


def save_graph(graph, folder):
    """Each step stands on a line of its own, for people who read or compare it."""
    rest = json.dumps({"name": graph.name, "renders": graph.renders, "comparisons": graph.comparisons})
    steps = ",\n".join(json.dumps(vars(step)) for step in graph.steps)
    body = f'"steps": [\n{steps}\n],\n{rest[1:]}\n'
    write_whole(graph_path(folder), f"{first_line(body)}\n{body}")


def first_line(body):
    return f'{{"planVersion": {VERSION}, "sha256": "{hashlib.sha256(body.encode()).hexdigest()}",'


def read_graph(folder):
    """The text, as save_graph wrote it; else throws PlanError."""
    path = graph_path(folder)
    if not path.exists():
        raise PlanError(FILE_ACCESS, f"{folder}: is not the folder of a run: it has no plan.json; name one that plan wrote to")
    text = read_text(path)
    head, _, body = text.partition("\n")
    if head != first_line(body):
        raise PlanError(INVALID_CONTENT, f"{path}: is damaged or of another version of plan; export the pipeline again")
    return text


def load_graph(folder):
    content = json.loads(read_graph(folder))
    return Graph(content["name"], [Step(**step) for step in content["steps"]], content["renders"], content["comparisons"])


class Builder:
    """Collects the steps of a description."""

    def __init__(self, description, source_folder, run_folder, tools_folder):
        self.description = description
        self.source_folder = source_folder
        self.run_folder = run_folder
        self.tools_folder = tools_folder
        self.steps = []
        self.ids = set()
        self.makers = {}  # output: id

    def source(self, file):
        return pathlib.Path(os.path.relpath(self.source_folder / file, self.run_folder)).as_posix()

    def words(self, options):
        """Command-line words, and the files among them."""
        files = [self.source(word["file"]) for word in options if isinstance(word, dict)]
        return [word if isinstance(word, str) else self.source(word["file"]) for word in options], files

    def said(self, stage, item):
        """What the description says of a step's resources."""
        general = self.description.get("resources", {}).get(stage, {})
        return general if stage == "merge" else general | item.get("resources", {})

    def threads(self, stage, item):
        """-j, where the description says how many cores the step has."""
        said = self.said(stage, item)
        return ["-j", str(said["cores"])] if "cores" in said else []

    def add(self, stage, id, group, words, inputs, outputs, item, **more):
        tool = {"import": "rt-import", "grid": "rt-grid", "compare": "rt-compare"}.get(stage, "rt-trace")
        program = (self.tools_folder / tool).as_posix() if self.tools_folder else tool
        depends_on = list(dict.fromkeys(self.makers[file] for file in inputs if file in self.makers))
        step = Step(id, stage, group, [program, *words], inputs, outputs, depends_on, RESOURCES[stage] | self.said(stage, item), **more)
        if id in self.ids:
            raise PlanError(INVALID_CONTENT, f"two steps would be called {id}: a name and a frame read like another name; rename one")
        self.ids.add(id)
        self.steps.append(step)
        self.makers.update({output: id for output in outputs})
        return step


def build_graph(description, name, source_folder, run_folder, tools_folder=None):
    """The same description, folders and tools give the same graph. Folders are absolute."""
    builder = Builder(description, source_folder, run_folder, tools_folder)
    for key, scene in description["scenes"].items():
        add_scene(builder, key, scene)
    for key, atlas in description["atlases"].items():
        add_atlas(builder, key, atlas)
    renders = {key: add_render(builder, key, render) for key, render in description["renders"].items()}
    comparisons = description.get("comparisons", {}).items()
    return Graph(name, builder.steps, renders, {key: add_comparison(builder, key, item, renders) for key, item in comparisons})


def add_scene(builder, name, scene):
    inputs = [builder.source(file) for file in scene["inputs"]]
    options, files = builder.words(scene.get("options", []))
    words = [*inputs, "-o", f"{name}.rtmesh", "--depfile", f"{name}.d", "--if-changed", *builder.threads("import", scene), *options]
    id = f"import-{name}"
    builder.add("import", id, id, words, inputs + files, [f"{name}.rtmesh"], scene, depfile=f"{name}.d")


def add_atlas(builder, name, atlas):
    options, files = builder.words(atlas.get("options", []))
    chosen = [word for key in ("structure", "quality") if key in atlas for word in (f"--{key}", atlas[key])]
    mesh = f"{atlas['scene']}.rtmesh"
    words = [mesh, "-o", f"{name}.rtatlas", "--if-changed", *chosen, *builder.threads("grid", atlas), *options]
    id = f"grid-{name}"
    builder.add("grid", id, id, words, [mesh, *files], [f"{name}.rtatlas"], atlas)


def add_render(builder, name, render):
    """The pictures, in order of their frames."""
    atlas = f"{render['atlas']}.rtatlas"
    options, files = render_words(builder, render)
    shards = render.get("shards", 1)
    pictures = []
    for first, last in frame_ranges(render):
        id = f"trace-{name}" + ("" if first is None else f"-{first:04d}")
        base = f"{name}/{name}" + ("" if first is None else ".%04d")
        frames = [] if first is None else ["--frames", f"{first}-{last}"]
        made = [base] if first is None else [base % frame for frame in range(first, last + 1)]
        if shards == 1:
            outputs = [f"{stem}{end}" for stem in made for end in (".exr", ".png")]
            words = [atlas, "-o", f"{base}.exr", "-o", f"{base}.png", *render.get("pngOptions", []), *frames, *options]
            builder.add("trace", id, f"trace-{name}", words, [atlas, *files], outputs, render)
        else:
            add_shards(builder, name, render, id, base, [atlas, *options, *frames], [atlas, *files], made[0])
        pictures += [{"exr": f"{stem}.exr", "step": builder.makers[f"{stem}.exr"]} for stem in made]
    return pictures


def add_shards(builder, name, render, id, base, words, inputs, stem):
    count = render["shards"]
    parts = []
    for i in range(1, count + 1):
        part = f"part{i}of{count}.exr"
        shard = ["--shard", f"{i}/{count}"] + (["--shard-by", render["shardBy"]] if "shardBy" in render else [])
        parts.append(f"{stem}.{part}")
        builder.add("trace", f"{id}-{i}of{count}", f"trace-{name}", [*words, "-o", f"{base}.{part}", *shard],
                    inputs, [parts[-1]], render)  # fmt: skip
    outputs = [f"{stem}.exr", f"{stem}.png"]
    merge = ["merge", *parts, "-o", outputs[0], "-o", outputs[1], *render.get("pngOptions", []), "--if-changed",
             *builder.threads("merge", render)]  # fmt: skip
    builder.add("merge", id.replace("trace-", "merge-", 1), f"merge-{name}", merge, parts, outputs, render)


def render_words(builder, render):
    options, files = builder.words(render.get("options", []))
    words = ["--reproducible", "--if-changed"]
    if "size" in render:
        words += ["--size", "x".join(map(str, render["size"]))]
    if "camera" in render:
        words += ["--camera", render["camera"]]
    if "cameraPath" in render:
        files = [builder.source(render["cameraPath"]), *files]
        words += ["--camera-path", files[0]]
    if "passes" in render:
        words += ["--aov", ",".join(render["passes"])]
    return words + builder.threads("trace", render) + options, files


def frame_ranges(render):
    """(first, last) of each step; (None, None) for a still."""
    if "frames" not in render:
        return [(None, None)]
    first, last = render["frames"]
    size = render.get("framesPerStep", 1)
    return [(frame, min(frame + size - 1, last)) for frame in range(first, last + 1, size)]


def add_comparison(builder, name, comparison, renders):
    """A step for each picture, because each has a page of its own."""
    pictures = renders[comparison["render"]]
    frames = frames_of(builder.description["renders"][comparison["render"]])
    number = ["" if frame is None else f".{frame:04d}" for frame in frames]
    if "golden" in comparison:
        check_goldens(builder, name, comparison, frames)
        references = [builder.source(golden_of(comparison["golden"], frame)) for frame in frames]
    else:
        references = [picture["exr"] for picture in renders[comparison["against"]]]
    options, files = builder.words(comparison.get("options", []))
    limits = [word for key, value in comparison.get("limits", {}).items() for word in (f"--{key}", str(value))]
    made = []
    for picture, reference, n in zip(pictures, references, number):
        stem, id = (f"{name}/{name}{n}", f"compare-{name}{n.replace('.', '-')}")
        outputs = [f"{stem}.passed", f"{stem}.html", f"{stem}.json"]
        words = [picture["exr"], reference, *limits, "--html", outputs[1], "--json", outputs[2], "--if-changed",
                 *builder.threads("compare", comparison), *options]  # fmt: skip
        builder.add("compare", id, f"compare-{name}", words, [picture["exr"], reference, *files], outputs, comparison,
                    stamp=outputs[0])  # fmt: skip
        golden = reference if "golden" in comparison and reference not in builder.makers else ""
        made.append({"step": id, "page": f"{stem}.html", "figures": f"{stem}.json", "exr": picture["exr"], "golden": golden})
    return made


def check_goldens(builder, name, comparison, frames):
    """Throws PlanError if one is a picture of the render itself, which would always pass."""
    own = {f"trace-{comparison['render']}", f"merge-{comparison['render']}"}
    made = {output for step in builder.steps if step.group in own for output in step.outputs}
    for frame in frames:
        path = os.path.realpath(builder.source_folder / golden_of(comparison["golden"], frame))
        if os.path.relpath(path, builder.run_folder) in made:
            raise PlanError(INVALID_CONTENT, f"$.comparisons.{name}.golden: {path} is made by '{comparison['render']}' itself; name another file")


def golden_of(golden, frame):
    return golden if frame is None else re.sub(r"%(0\d+)?d", lambda found: found[0] % frame, golden)


def frames_of(render):
    """[None] of a still."""
    first, last = render.get("frames", (None, None))
    return [None] if first is None else range(first, last + 1)
