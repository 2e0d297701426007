"""Measures the thesis' scenes through its structures and ours: see README.md."""
import argparse
import pathlib
import sys

HERE = pathlib.Path(__file__).resolve().parent
sys.path.insert(0, str(HERE.parent / "benchmark"))
import run as bench  # noqa: E402  the two have their steps, options and tables in common

import figures  # noqa: E402

TOOLS = ("rt-import", "rt-grid", "rt-trace", "rt-compare")
SIZES = (256, 512, 1024)
REDUCED_SIZE = 64
PICTURE_SIZE = "360x360"  # of those that are looked at
COLUMNS = (
    "scene", "triangles", "structure", "built", "grid", "kernel", "size", "ms", "min_ms", "passes", "rays",
    "steps_per_ray", "tests_per_ray", "proximity_max", "proximity_mean", "empty", "structure_bytes", "rmse",
    "ids_differing", "device", "note",
)  # fmt: skip
# As the thesis cast rays: a black light asks for no shadows, and all that surfaces show is their own colour.
LIGHT = ("--light", "0,0,0,0,0,0", "--ambient", "1")
# Rays that meet an edge may take either triangle, and refraction magnifies roundings.
LIMITS = ("--max-rmse", "5e-3", "--max-differing", "id=2e-3")


def grids_of(scene):
    """(structure, its options for rt-grid, how many voxels the thesis' grid has on each side)."""
    grids = [("ours", (), "")]
    for side in reversed(scene["grids"]):
        fixed = ("--resolution", f"{side}x{side}x{side}")
        grids = [(name, ("--structure", name, *fixed), side) for name in ("uniform", "cloud")] + grids
    return grids


class Thesis(bench.SceneRunner):
    def __init__(self, options):
        super().__init__(options)
        self.meshes, self.pictures = self.out / "meshes", self.out / "pictures"
        self.meshes.mkdir(exist_ok=True)
        self.pictures.mkdir(exist_ok=True)

    def make_mesh(self, scene, folder):
        """Meshes are kept, to be measured on another machine; one that is there already is taken as it is."""
        mesh = self.meshes / f"{scene['name']}.rtmesh"
        if not mesh.exists():
            model = next((path for path in (HERE / scene["model"], self.options.scenes_dir / scene["model"]) if path.exists()), None)
            if model is None:
                self.log(f"{scene['name']}: skipped, {self.options.scenes_dir / scene['model']} is not there")
                return False
            words = [HERE / word if word.startswith("../") else word for word in scene.get("import", "").split()]
            bench.run(self.tools / "rt-import", model, *words, "-o", mesh)
        (folder / "scene.rtmesh").symlink_to(mesh.resolve())
        return True

    def measure(self, scene, folder):
        if self.options.meshes_only:
            return
        self.log(scene["name"])
        grids = [self.describe(scene, folder, *grid) for grid in grids_of(scene)]
        self.trace(scene, grids[-1][0], "-o", self.pictures / f"{scene['name']}.png", "--size", PICTURE_SIZE)
        for size in self.options.sizes or scene.get("sizes", SIZES):
            for kernel in self.options.kernels:
                for atlas, row in grids:
                    self.measure_one(scene, folder, atlas, row | {"kernel": kernel, "size": size})

    def trace(self, scene, atlas, *arguments):
        bench.run(self.tools / "rt-trace", atlas, *scene.get("view", "").split(), *arguments, "--device", self.options.device)

    def measure_one(self, scene, folder, atlas, row):
        try:
            self.trace_or_skip(row, lambda row: self.render(scene, folder, atlas, row), row["kernel"])
        except bench.StepFailed as error:
            self.rows.append(row | {"note": str(error)})
            self.fault(f"{scene['name']}, {atlas.stem}, {row['kernel']}, {row['size']}: {error}")

    def describe(self, scene, folder, structure, options, side):
        """Builds an atlas; its path, and what it puts into each of its rows."""
        name = f"{structure}{side}"
        atlas, report = folder / f"{name}.rtatlas", self.details / f"{scene['name']}-{name}.json"
        bench.run(self.tools / "rt-grid", folder / "scene.rtmesh", "-o", atlas, *options, "--json", report)
        built = bench.load(report)
        bench.run(self.tools / "rt-grid", "inspect", atlas, "--json", report)
        seen = bench.load(report)
        row = dict.fromkeys(COLUMNS, "") | {"scene": scene["name"], "triangles": seen["triangles"], "structure": structure}
        row |= {"built": seen["structure"], "grid": side, "empty": 1.0 - seen["occupiedVolume"]}
        if structure == "cloud":
            row |= {"proximity_max": seen["distances"]["max"], "proximity_mean": seen["distances"]["mean"]}
        return atlas, row | {"structure_bytes": built["structureBytes"]}

    def render(self, scene, folder, atlas, row):
        """Renders a picture often enough to time it, and compares it with the first one of its size."""
        kernel, size = row["kernel"], row["size"]
        picture, reference = folder / "picture.exr", folder / f"{size}.exr"
        report = self.details / f"{scene['name']}-{atlas.stem}-{kernel}-{size}.json"
        choice = ["--kernel", kernel] if self.options.chooses_kernel else []
        passes = self.passes_for(row)
        repeat = ["--repeat", passes] if passes else []
        stats = ["--stats"] if kernel == "compute" else []  # the other one takes the same steps
        self.trace(scene, atlas, "-o", picture, "--size", f"{size}x{size}", *LIGHT, *choice, *repeat, *stats, "--json", report)
        traced = bench.load(report)
        row |= {"ms": traced["gpuMs"], "min_ms": traced.get("minMs", ""), "passes": passes or 1, "device": traced["device"]}
        if stats:
            row |= {"rays": traced["raysTotal"], "steps_per_ray": traced["stepsPerRay"], "tests_per_ray": traced["testsPerRay"]}
        if not reference.exists():
            picture.rename(reference)
            picture = reference
        failed = self.compare(picture, reference, report.with_name(f"{report.stem}-errors.json"), row)
        self.rows.append(row)
        self.log(f"  {kernel:10}{size:5}{row['structure']:>8} {row['grid'] or row['built']!s:7}{row['ms']:10.3f} ms "
                 f"{1e3 / row['ms']:8.1f} frames/s")  # fmt: skip
        if failed:
            self.fault(f"{scene['name']}, {atlas.stem}, {kernel}, {size}: RMSE {row['rmse']:.2g}, "
                       f"{row['ids_differing']:.2g} of the pixels show another triangle")  # fmt: skip

    def passes_for(self, row):
        """As many as asked for, or as fit into --seconds going by the next smaller picture."""
        same = ("scene", "structure", "grid", "kernel")
        smaller = [r for r in self.rows if r["ms"] != "" and all(r[key] == row[key] for key in same)]
        if not smaller or not self.options.repeat:
            return self.options.repeat
        expected = smaller[-1]["ms"] * (row["size"] / smaller[-1]["size"]) ** 2
        return max(1, min(self.options.repeat, int(1e3 * self.options.seconds / expected)))

    def compare(self, picture, reference, report, row):
        code = bench.run(self.tools / "rt-compare", picture, reference, *LIMITS, "--json", report, accept=(0, 1))
        layers = {layer["name"]: layer for layer in bench.load(report)["pairs"][0]["layers"]}
        row |= {"rmse": layers["color"]["rmse"], "ids_differing": layers["id"]["over"][0]["fraction"]}
        return code


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    bench.add_common_options(parser)
    parser.add_argument("--scenes", nargs="+", metavar="NAME", help="of scenes.json; all by default")
    parser.add_argument("--kernels", nargs="+", metavar="NAME", help="of rt-trace --help; all by default")
    parser.add_argument("--seconds", type=float, default=5.0, help="that the passes of one picture may take (5)")
    parser.add_argument("--meshes-only", action="store_true", help="import into OUT/meshes, to measure elsewhere")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--reduced", action="store_true", help=f"{REDUCED_SIZE}x{REDUCED_SIZE} pixels, one pass; so on software GL")
    size.add_argument("--full", action="store_true", help="all sizes, on software GL too")
    return parser.parse_args()


def complete(options):
    options.sizes = [options.size] if options.size else None
    repeat = options.repeat
    bench.complete(options, TOOLS, max(SIZES))
    if options.reduced:
        options.sizes = options.sizes or [REDUCED_SIZE]
        options.size = options.sizes[0]
        options.repeat = repeat or 0  # without warming up
    kernels = bench.help_choices(options.tools / "rt-trace", "kernel")
    options.chooses_kernel = bool(kernels)
    options.kernels = options.kernels or kernels or ["compute"]


def main():
    options = parse()
    complete(options)
    thesis = Thesis(options)
    results = options.out / "thesis.csv"
    scenes = bench.named_scenes(options.scenes, HERE)
    if options.meshes_only:
        thesis.run_scenes(scenes, lambda: None)
        return print(thesis.meshes)
    thesis.run_scenes(scenes, lambda: bench.write_csv(results, COLUMNS, thesis.rows, options.append))
    for path in (results, *figures.write(options.out)):
        print(path)
    thesis.exit_with_faults()


if __name__ == "__main__":
    main()
