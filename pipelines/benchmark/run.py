"""Measures rt-trace's ray queries and rt-grid's builds against Embree and checks every hit: see README.md."""
import argparse
import csv
import json
import os
import pathlib
import re
import shutil
import subprocess
import sys

import make_scene
import plot

HERE = pathlib.Path(__file__).resolve().parent
TOOLS = ("rt-import", "rt-grid", "rt-trace", "rt_make_rays", "rt_check_hits")
SETS = ("primary", "shadow", "diffuse", "random")
COLUMNS = (
    "scene", "triangles", "structure", "options", "built", "set", "rays", "hits", "mrays_per_s",
    "embree_mrays_per_s", "ratio", "ties", "near_ties", "grazing", "edges", "lost", "extra", "wrong",
    "bytes_per_triangle", "build_mtris_per_s", "embree_build_mtris_per_s", "threads", "device", "note",
)  # fmt: skip


TRACE_LIMIT = ("rt-trace", 5)  # its exit code where a limit was hit


class StepFailed(Exception):
    def __init__(self, message, ended=None):
        super().__init__(message)
        self.ended = ended  # which tool with which exit code


def run(tool, *arguments, accept=(0,)):
    """Runs one of the tools; its exit code. Raises StepFailed with its last message for codes not accepted."""
    result = subprocess.run([tool, *map(str, arguments), "-q"], capture_output=True, text=True)
    if result.returncode not in accept:
        lines = result.stderr.strip().splitlines() or [f"ended with exit code {result.returncode}"]
        raise StepFailed(lines[-1], (tool.name, result.returncode))
    return result.returncode


def load(path):
    return json.loads(path.read_text())


def help_choices(tool, option):
    """The values that a tool's --help lists for an option, `--structure uniform|cloud|...`; none if it has no such option."""
    text = subprocess.run([tool, "--help"], capture_output=True, text=True, check=True).stdout
    match = re.search(rf"^\s+--{option}[ =]([a-z]+(?:\|[a-z]+)+)", text, re.MULTILINE)
    return match.group(1).split("|") if match else []


def all_variants(tools):
    """(structure, further options): every structure, and `auto` in every quality."""
    qualities = [("--quality", quality) for quality in help_choices(tools / "rt-grid", "quality")]
    variants = []
    for structure in help_choices(tools / "rt-grid", "structure"):
        variants += [(structure, q) for q in qualities] if structure == "auto" and qualities else [(structure, ())]
    return variants


def parse_variant(text):
    """'cloud' or 'cloud --density 4' as all_variants() gives them."""
    structure, *options = text.split()
    return structure, tuple(options)


def is_software(tools, device):
    """Whether rt-trace --device DEVICE is a software renderer; `auto` takes hardware where there is any."""
    text = subprocess.run([tools / "rt-trace", "--list-devices"], capture_output=True, text=True, check=True).stdout
    kinds = dict(re.findall(r"^(\d+)\s+(software|hardware)\b", text, re.MULTILINE))
    if device == "auto":
        return "hardware" not in kinds.values()
    return device == "software" or kinds.get(device) == "software"


class SceneRunner:
    """What benchmarks have in common: each imports scenes one by one and measures what it will in a folder of its own."""

    def __init__(self, options):
        self.options = options
        self.tools = options.tools
        self.out = options.out
        self.details = self.out / "json"
        self.rows = []
        self.faults = []

    def log(self, text):
        print(text, file=sys.stderr, flush=True)

    def fault(self, text):
        self.faults.append(text)
        self.log(f"  FAILED {text}")

    def trace_or_skip(self, row, trace, label):
        """Runs trace(row). What a software renderer's limits do not let it trace becomes a row with a note, no failure."""
        try:
            trace(row)
        except StepFailed as error:
            if error.ended != TRACE_LIMIT or not self.options.software:
                raise
            self.rows.append(row | {"note": f"skipped: {error}"})
            self.log(f"    {label:8}skipped: {error}")

    def scene_model(self, scene, folder):
        """The model file of a scene, generated where it has to be; None if a model is not there."""
        source = self.options.scenes_dir / scene["model"] if "model" in scene else None
        if source is not None and not source.is_file():
            return None
        make = scene.get("reducedMake") if self.options.reduced else None
        make = make or scene.get("make")
        if make is None:
            return source
        path = folder / "scene.ply"
        make_scene.make(path, *make, *([str(source)] if source else []))
        return path

    def make_mesh(self, scene, folder):
        """Imports scene.rtmesh; False if the model is not there."""
        model = self.scene_model(scene, folder)
        if model is None:
            self.log(f"{scene['name']}: skipped, {self.options.scenes_dir / scene['model']} is not there")
            return False
        run(self.tools / "rt-import", model, "-o", folder / "scene.rtmesh")
        return True

    def run_scene(self, scene):
        name = scene["name"]
        folder = self.out / "work" / name
        shutil.rmtree(folder, ignore_errors=True)
        folder.mkdir(parents=True)
        try:
            if self.make_mesh(scene, folder):
                self.measure(scene, folder)
        except StepFailed as error:
            self.fault(f"{name}: {error}")
        finally:
            shutil.rmtree(folder)

    def run_scenes(self, scenes, write):
        """Runs all, calling write() after each, so that what was measured stays whatever comes after it."""
        self.details.mkdir(parents=True, exist_ok=True)
        (self.out / "work").mkdir(exist_ok=True)
        if self.options.reduced:
            size = self.options.size
            self.log(f"Reduced run: {size}x{size} rays; its speeds say nothing about a GPU")
        for scene in scenes:
            self.run_scene(scene)
            write()
        shutil.rmtree(self.out / "work")

    def exit_with_faults(self):
        if not self.rows:
            sys.exit("nothing was measured")
        if self.faults:
            sys.exit("\n".join([f"{len(self.faults)} failures:", *self.faults]))

    def make_rays(self, scene, folder):
        view = [f"--{key}={value}" for key, value in scene.get("view", {}).items()]
        report = self.details / f"{scene['name']}-rays.json"
        run(self.tools / "rt_make_rays", folder / "scene.rtmesh", "-o", folder, *view, "--json", report,
            f"--size={self.options.size}", f"--embree-repeat={self.options.embree_repeat}")  # fmt: skip
        rays = load(report)
        speeds = " / ".join(f"{rays['sets'][s]['embreeMraysPerSecond']:.1f}" for s in SETS)
        self.log(f"{scene['name']}: {rays['triangles']:,} triangles; Embree {speeds} Mrays/s")
        return rays

    def build(self, folder, structure, options, prefix):
        """Builds scene.rtatlas; what rt-grid reports."""
        report = self.details / f"{prefix}.json"
        run(self.tools / "rt-grid", folder / "scene.rtmesh", "-o", folder / "scene.rtatlas", "--structure", structure,
            *options, "--json", report)  # fmt: skip
        return load(report)


def file_prefix(scene, variant):
    return f"{scene}-{re.sub('[^a-z0-9.]+', '-', variant)}"


class Benchmark(SceneRunner):
    def measure(self, scene, folder):
        rays = self.make_rays(scene, folder)
        for structure, options in self.options.variants:
            self.run_variant(scene["name"], folder, rays, structure, options)

    def run_variant(self, scene, folder, rays, structure, options):
        variant = " ".join((structure, *options))
        prefix = file_prefix(scene, variant)
        row = dict.fromkeys(COLUMNS, "")
        row |= {"scene": scene, "triangles": rays["triangles"], "structure": structure, "options": " ".join(options)}
        row |= {"embree_build_mtris_per_s": rays["embreeBuildMtrisPerSecond"], "threads": rays["threads"]}
        try:
            grid = self.build(folder, structure, options, prefix)
            row["built"] = grid["structure"]
            row["bytes_per_triangle"] = grid["bytesPerTriangle"]
            row["build_mtris_per_s"] = grid["triangles"] / (grid["buildMs"] * 1e3)
            self.log(f"  {variant}: built at {row['build_mtris_per_s']:.2f} Mtriangles/s, "
                     f"{row['bytes_per_triangle']:.0f} bytes per triangle")  # fmt: skip
            for name in SETS:
                self.trace_or_skip(row | {"set": name}, lambda row: self.run_set(
                    row, folder, rays["sets"][row["set"]], f"{prefix}-{row['set']}"), name)  # fmt: skip
        except StepFailed as error:
            self.rows.append(row | {"note": str(error)})
            self.fault(f"{scene}, {variant}: {error}")
        finally:
            (folder / "scene.rtatlas").unlink(missing_ok=True)

    def run_set(self, row, folder, expected, prefix):
        """Traces one set, checks its hits and adds its row."""
        rays, got = folder / f"{row['set']}.rays", folder / "got.hits"
        any_hit = ["--any-hit"] if expected["anyHit"] else []
        repeat = ["--repeat", self.options.repeat] if self.options.repeat > 0 else []
        report = self.details / f"{prefix}.json"
        run(self.tools / "rt-trace", folder / "scene.rtatlas", "--rays", rays, "-o", got, *any_hit, *repeat,
            "--device", self.options.device, "--json", report)  # fmt: skip
        traced = load(report)
        checked = self.details / f"{prefix}-hits.json"
        allowed = int(self.options.allow_per_million * 1e-6 * expected["rays"])
        failed = run(self.tools / "rt_check_hits", folder / f"{row['set']}.hits", got, "--rays", rays, *any_hit,
                     "--mesh", folder / "scene.rtmesh", "--allow", allowed, "--json", checked, accept=(0, 1))  # fmt: skip
        counts = load(checked)
        embree = expected["embreeMraysPerSecond"]
        row |= {"rays": expected["rays"], "hits": traced["hits"], "mrays_per_s": traced["mraysPerSecond"]}
        row |= {"embree_mrays_per_s": embree, "ratio": traced["mraysPerSecond"] / embree, "device": traced["device"]}
        row |= {"ties": counts["ties"], "near_ties": counts["nearTies"]}
        row |= {key: counts[key] for key in ("grazing", "edges", "lost", "extra", "wrong")}
        self.rows.append(row)
        self.log(f"    {row['set']:8}{row['mrays_per_s']:10.1f} Mrays/s {row['ratio']:8.2f} x Embree, ties and edges "
                 f"{sum(row[key] for key in ('ties', 'near_ties', 'grazing', 'edges'))}")  # fmt: skip
        if failed:
            faults = ", ".join(f"{counts[key]} {key}" for key in ("lost", "extra", "wrong"))
            variant = " ".join(filter(None, (row["structure"], row["options"])))
            self.fault(f"{row['scene']}, {variant}, {row['set']}: {faults}")


def rounded(value):
    return f"{value:.5g}" if isinstance(value, float) else value


def write_csv(path, columns, rows, append):
    """Writes all rows; `append` keeps those of other scenes that are in the file already."""
    ran = {row["scene"] for row in rows}
    kept = []
    if append and path.exists():
        with open(path, newline="", encoding="utf-8") as file:
            kept = [row for row in csv.DictReader(file) if row["scene"] not in ran]
    with open(path, "w", newline="", encoding="utf-8") as file:
        writer = csv.DictWriter(file, columns, lineterminator="\n")
        writer.writeheader()
        writer.writerows(kept + [{key: rounded(value) for key, value in row.items()} for row in rows])


def whole(least):
    """Type of an option: a whole number from `least` on."""
    def parse(text):
        number = int(text)
        if number < least:
            raise ValueError
        return number
    parse.__name__ = f"whole number from {least} on"
    return parse


def add_common_options(parser):
    """Those of every benchmark here."""
    parser.add_argument("--tools", type=pathlib.Path, required=True, help="folder of the built programs")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="folder for the tables and the plots")
    scenes = os.environ.get("RT_SCENES_DIR") or HERE.parents[2] / "shared" / "scenes"
    parser.add_argument("--scenes-dir", type=pathlib.Path, default=scenes, help="folder with models/ (%(default)s)")
    parser.add_argument("--device", default="auto", help="as rt-trace --device takes it")
    parser.add_argument("--size", type=whole(8), help="side of the primary rays' picture")
    parser.add_argument("--repeat", type=whole(0), help="passes of rt-trace; 0 is one without warming up")
    parser.add_argument("--append", action="store_true", help="keep the rows of other scenes in the tables")


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    add_common_options(parser)
    parser.add_argument("--scenes", nargs="+", metavar="NAME", help="of scenes.json; all by default")
    parser.add_argument("--variants", nargs="+", metavar="'STRUCTURE [OPTIONS]'", help="for rt-grid; all by default")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--reduced", action="store_true", help="256x256, one pass, small scenes unless --scenes names others; so on software GL")
    size.add_argument("--full", action="store_true", help="all scenes, 2048x2048, on software GL too")
    parser.add_argument("--embree-repeat", type=whole(1), help="passes and builds of Embree")
    parser.add_argument("--allow-per-million", type=float, default=0.0, metavar="N",
                        help="lost, extra and wrong hits per million rays that still pass (0)")  # fmt: skip
    return parser.parse_args()


def complete(options, tools, full_size):
    """Fills in what depends on the device and makes the folder --out; the programs `tools` have to be there."""
    options.tools = options.tools.resolve()
    missing = [tool for tool in tools if shutil.which(options.tools / tool) is None]
    if missing:
        sys.exit(f"{options.tools}: {' '.join(missing)} not there; build them, see README.md")
    try:
        options.out.mkdir(parents=True, exist_ok=True)
    except OSError as error:
        sys.exit(f"--out {options.out}: {error.strerror}; name a folder")
    options.software = is_software(options.tools, options.device)
    options.reduced = options.reduced or (options.software and not options.full)
    options.size = options.size or (256 if options.reduced else full_size)
    if options.repeat is None:
        options.repeat = 1 if options.reduced else 15


def named_scenes(names, folder=HERE):
    """Those of a folder's scenes.json; all without names."""
    known = {scene["name"]: scene for scene in load(folder / "scenes.json")}
    unknown = sorted(set(names or ()) - set(known))
    if unknown:
        sys.exit(f"no such scene: {' '.join(unknown)}; there are {' '.join(known)}")
    return [known[name] for name in names or known]


def main():
    options = parse()
    complete(options, TOOLS, 2048)
    options.embree_repeat = options.embree_repeat or (1 if options.reduced else 3)
    variants = options.variants
    options.variants = [parse_variant(v) for v in variants] if variants else all_variants(options.tools)
    scenes = named_scenes(options.scenes)
    if options.reduced and not options.scenes:
        scenes = [scene for scene in scenes if scene.get("reduced")]
    benchmark = Benchmark(options)
    results = options.out / "results.csv"
    benchmark.run_scenes(scenes, lambda: write_csv(results, COLUMNS, benchmark.rows, options.append))
    print(results)
    for path in plot.draw(results, options.out):
        print(path)
    benchmark.exit_with_faults()


if __name__ == "__main__":
    main()
