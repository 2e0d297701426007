"""Measures rt-trace's speed against its error relative to double precision, of rays and pictures: see README.md."""
import argparse
import math

import error_page
import run as bench

TOOLS = ("rt-import", "rt-grid", "rt-trace", "rt-compare", "rt_make_rays", "rt_measure_hits", "rt_box_filter")
INTERSECTS = ("watertight", "moller-trumbore", "baldwin-webber")
PRECISIONS = ("float", "double")
REFERENCE = ("watertight", "double")
DEFAULT_SCENES = ("bunny", "sponza")
CASE = ("scene", "triangles", "structure", "options", "bytes_per_triangle", "intersect", "precision")
ERRORS = {"t": "tRelative", "position": "positionDiagonals", "normal": "normalRadians"}  # as rt_measure_hits reports
SPREAD = ("median", "p999", "max")
RATES = {"wrong_triangle_rate": "wrongTriangleRate", "leak_rate": "leakRate"}
COUNTS = {
    "compared": "compared", "ties": "ties", "near_ties": "nearTies", "grazing": "grazing", "edges": "edges",
    "lost": "lost", "extra": "extra", "wrong": "wrong", "wrong_triangles": "wrongTriangles",
}  # fmt: skip
ERROR_COLUMNS = (
    *CASE, "set", "rays", "hits", "mrays_per_s", *(f"{error}_{part}" for error in ERRORS for part in SPREAD), *RATES,
    *COUNTS, "device", "note",
)  # fmt: skip
PICTURE_COLUMNS = (*CASE, "width", "height", "spp", "ms", "rmse", "max_error", "device", "note")


def blank_if_none(report, names):
    """{column: value of the report}; JSON has null where nothing could be measured."""
    return {column: "" if report[name] is None else report[name] for column, name in names.items()}


class ErrorBenchmark(bench.SceneRunner):
    """The first variant gives the reference, and the pictures."""

    def __init__(self, options):
        super().__init__(options)
        self.pictures = []

    def measure(self, scene, folder):
        rays = self.make_rays(scene, folder)
        for number, (structure, options) in enumerate(self.options.variants):
            variant = " ".join((structure, *options))
            prefix = "error-" + bench.file_prefix(scene["name"], variant)
            case = dict.fromkeys(CASE, "") | {"scene": scene["name"], "triangles": rays["triangles"]}
            case |= {"structure": structure, "options": " ".join(options)}
            try:
                case["bytes_per_triangle"] = self.build(folder, structure, options, prefix)["bytesPerTriangle"]
                self.log(f"  {variant}")
                if number == 0:
                    self.trace_references(folder)
                    self.render_all(scene, case, folder, prefix)
                self.trace_all(case, folder, prefix)
            except bench.StepFailed as error:
                self.rows.append(dict.fromkeys(ERROR_COLUMNS, "") | case | {"note": str(error)})
                self.fault(f"{scene['name']}, {variant}: {error}")
                if number == 0:
                    raise bench.StepFailed("there is no reference without its first structure") from error

    def trace(self, folder, *arguments):
        bench.run(self.tools / "rt-trace", folder / "scene.rtatlas", *arguments, "--device", self.options.device)

    def trace_references(self, folder):
        intersect, precision = REFERENCE
        for name in self.options.sets:
            self.trace(folder, "--rays", folder / f"{name}.rays", "-o", folder / f"{name}.reference", "--precision",
                       precision, "--intersect", intersect)  # fmt: skip

    def trace_all(self, case, folder, prefix):
        for intersect in self.options.intersects:
            for precision in self.options.precisions:
                for name in self.options.sets:
                    row = dict.fromkeys(ERROR_COLUMNS, "") | case
                    row |= {"intersect": intersect, "precision": precision, "set": name}
                    self.trace_or_skip(row, lambda row: self.trace_set(
                        row, folder, f"{prefix}-{row['intersect']}-{row['precision']}-{row['set']}"), name)  # fmt: skip

    def trace_set(self, row, folder, prefix):
        """Traces one set of rays, measures its errors and adds its row."""
        rays, got = folder / f"{row['set']}.rays", folder / "got.hits"
        repeat = ["--repeat", self.options.repeat] if self.options.repeat > 0 else []
        traced, measured = self.details / f"{prefix}.json", self.details / f"{prefix}-errors.json"
        self.trace(folder, "--rays", rays, "-o", got, "--precision", row["precision"], "--intersect", row["intersect"],
                   *repeat, "--json", traced)  # fmt: skip
        bench.run(self.tools / "rt_measure_hits", folder / f"{row['set']}.reference", got, "--rays", rays, "--mesh",
                  folder / "scene.rtmesh", "--json", measured)  # fmt: skip
        speed, errors = bench.load(traced), bench.load(measured)
        row |= {"rays": errors["rays"], "hits": errors["hits"], "mrays_per_s": speed["mraysPerSecond"]}
        row |= {"device": speed["device"]}
        row |= blank_if_none(errors, COUNTS | RATES)
        for column, name in ERRORS.items():
            row |= blank_if_none(errors[name], {f"{column}_{part}": part for part in SPREAD})
        self.rows.append(row)
        self.log(f"    {row['intersect']:16}{row['precision']:7}{row['set']:8}{row['mrays_per_s']:10.2f} Mrays/s, "
                 f"t off by {row['t_p999'] or 0:.1e} (99.9 %), {row['lost']} lost, {row['wrong_triangles']} of "
                 f"wrong triangles")  # fmt: skip

    def render_all(self, scene, case, folder, prefix):
        """Pictures of all tests, precisions and samples against the exact one of the most samples."""
        side, view = self.options.picture_size, view_options(scene)
        most = max(self.options.spp)
        reference = folder / "reference.exr"
        self.render(folder, view, REFERENCE, most, reference, self.details / f"{prefix}-picture.json")
        for intersect in self.options.intersects:
            for precision in self.options.precisions:
                for spp in self.options.spp:
                    row = dict.fromkeys(PICTURE_COLUMNS, "") | case
                    row |= {"intersect": intersect, "precision": precision, "spp": spp, "width": side, "height": side}
                    report = self.details / f"{prefix}-{intersect}-{precision}-{spp}spp.json"
                    picture = folder / "picture.exr"
                    row |= self.render(folder, view, (intersect, precision), spp, picture, report)
                    row |= self.compare(picture, reference, self.details / f"{report.stem}-errors.json")
                    self.pictures.append(row)
                    self.log(f"    {intersect:16}{precision:7}{spp:4} spp{row['ms']:10.3f} ms, RMSE {row['rmse']:.2e}")

    def render(self, folder, view, case, spp, picture, report):
        """Renders large and averages; the time of the fastest of some runs, since a run does not warm the device up."""
        intersect, precision = case
        factor = math.isqrt(spp)
        large, size = folder / "large.exr", self.options.picture_size * factor
        runs = []
        for _ in range(self.options.picture_runs):
            self.trace(folder, "-o", large, "--size", f"{size}x{size}", *view, "--precision", precision, "--intersect",
                       intersect, "--json", report)  # fmt: skip
            runs.append(bench.load(report))
        bench.run(self.tools / "rt_box_filter", large, "-o", picture, "--side", factor)
        return {"ms": min(r["gpuMs"] for r in runs), "device": runs[0]["device"]}

    def compare(self, picture, reference, report):
        bench.run(self.tools / "rt-compare", picture, reference, "--json", report, accept=(0, 1))
        layers = bench.load(report)["pairs"][0]["layers"]
        color = next(layer for layer in layers if layer["name"] == "color")
        return {"rmse": color["rmse"], "max_error": color["maxAbs"]}


def view_options(scene):
    """rt-trace's names of what scenes.json says of the camera and the light."""
    names = {"eye": "--eye", "target": "--look-at", "up": "--up", "fov": "--fov", "light": "--light"}
    return [f"{names[key]}={value}" for key, value in scene.get("view", {}).items()]


def square(text):
    number = int(text)
    if number < 1 or math.isqrt(number) ** 2 != number:
        raise ValueError
    return number


square.__name__ = "square number"  # for messages


def parse():
    parser = argparse.ArgumentParser(description=__doc__)
    bench.add_common_options(parser)
    parser.add_argument("--scenes", nargs="+", metavar="NAME", help=f"of scenes.json; by default {' '.join(DEFAULT_SCENES)}")
    parser.add_argument("--structures", nargs="+", default=["nested", "cloud"], metavar="NAME",
                        help="of rt-grid; the first one's hits and picture in double precision are the reference (nested cloud)")  # fmt: skip
    parser.add_argument("--densities", nargs="+", type=float, metavar="D", help="of rt-grid; each structure's own by default")
    parser.add_argument("--intersects", nargs="+", default=INTERSECTS, choices=INTERSECTS)
    parser.add_argument("--precisions", nargs="+", default=PRECISIONS, choices=PRECISIONS)
    parser.add_argument("--sets", nargs="+", default=["diffuse"], choices=("primary", "diffuse", "random"),
                        help="of rays (diffuse)")  # fmt: skip
    parser.add_argument("--spp", nargs="+", type=square, default=[1, 4, 16, 64], metavar="K*K",
                        help="samples per pixel of the pictures (1 4 16 64)")  # fmt: skip
    parser.add_argument("--picture-size", type=bench.whole(1), help="side of the pictures")
    parser.add_argument("--picture-runs", type=bench.whole(1), help="of which the fastest counts")
    size = parser.add_mutually_exclusive_group()
    size.add_argument("--reduced", action="store_true", help="256x256 rays, 64x64 pixels, one pass; so on software GL")
    size.add_argument("--full", action="store_true", help="all scenes unless --scenes names some, 1024x1024 rays, on software GL too")
    return parser.parse_args()


def complete(options):
    bench.complete(options, TOOLS, 1024)
    options.picture_size = options.picture_size or (64 if options.reduced else 256)
    options.picture_runs = options.picture_runs or (1 if options.reduced else 2)
    options.embree_repeat = 1  # its speed is no part of this
    densities = [("--density", f"{density:g}") for density in options.densities or ()] or [()]
    options.variants = [(structure, density) for structure in options.structures for density in densities]


def main():
    options = parse()
    complete(options)
    scenes = bench.named_scenes(options.scenes or (None if options.full else DEFAULT_SCENES))
    benchmark = ErrorBenchmark(options)
    errors, pictures = options.out / "errors.csv", options.out / "pictures.csv"

    def write():
        bench.write_csv(errors, ERROR_COLUMNS, benchmark.rows, options.append)
        bench.write_csv(pictures, PICTURE_COLUMNS, benchmark.pictures, options.append)

    benchmark.run_scenes(scenes, write)
    for path in (errors, pictures, *error_page.write(options.out)):
        print(path)
    benchmark.exit_with_faults()


if __name__ == "__main__":
    main()
