"""Renders the scenes of gallery.json and says what a sample of each costs: see README.md."""
import argparse
import json
import os
import pathlib
import subprocess
import sys

HERE = pathlib.Path(__file__).resolve().parent


def run(tool, *arguments):
    result = subprocess.run([tool, *map(str, arguments), "-q"], capture_output=True, text=True)
    if result.returncode != 0:
        raise RuntimeError((result.stderr.strip().splitlines() or [f"{tool} ended with {result.returncode}"])[-1])


def found(word, folder):
    """An option that names a file of the scenes folder, as its path there."""
    return folder / word if word.startswith("images/") else word


def model_of(scene, options):
    """A scene file stands here, and names models of the scenes folder; other models stand there."""
    own = HERE / scene["model"]
    return own if own.exists() else options.scenes_dir / scene["model"]


def render(scene, options):
    """The report of rt-trace."""
    stem = options.out / scene["name"]
    mesh, atlas, report = (stem.with_suffix(end) for end in (".rtmesh", ".rtatlas", ".json"))
    run(options.tools / "rt-import", model_of(scene, options), "--texture-root", options.scenes_dir, "-o", mesh)
    run(options.tools / "rt-grid", mesh, "-o", atlas, "--quality", "best")
    words = [found(word, options.scenes_dir) for word in scene["options"].split()]
    outputs = ["-o", stem.with_suffix(".png"), "-o", stem.with_suffix(".exr")]
    run(options.tools / "rt-trace", atlas, *words, *outputs, "--size", options.size, "--spp", options.spp,
        "--filter", "gaussian", "--device", options.device, "--stats", "--json", report)  # fmt: skip
    return json.loads(report.read_text())


def line(name, report):
    samples = report["samples"]["mean"]
    stages = report["deviceStages"]
    whole = sum(stages.values())
    rays = report["raysTotal"] / (report["width"] * report["height"] * samples)
    return (f"{name:20} {report['atlas']['triangles']:>9,} triangles {report['gpuMs'] / samples:9.2f} ms a sample "
            f"{rays:6.2f} rays a sample {report['mraysPerSecond']:8.1f} Mrays/s "
            f"({', '.join(f'{name[:-2]} {100 * ms / whole:.0f} %' for name, ms in stages.items())})")  # fmt: skip


def parse_options():
    parser = argparse.ArgumentParser(description=__doc__)
    scenes_dir = os.environ.get("RT_SCENES_DIR", HERE.parent.parent.parent / "shared" / "scenes")
    parser.add_argument("--tools", type=pathlib.Path, required=True, help="folder of the built programs")
    parser.add_argument("--out", type=pathlib.Path, required=True, help="made if it is not there")
    parser.add_argument("--scenes-dir", type=pathlib.Path, default=scenes_dir, help="$RT_SCENES_DIR")
    parser.add_argument("--scenes", nargs="+", help="names in gallery.json; all by default")
    parser.add_argument("--size", default="1280x720")
    parser.add_argument("--spp", type=int, default=64)
    parser.add_argument("--device", default="auto")
    return parser.parse_args()


def main():
    options = parse_options()
    options.out.mkdir(parents=True, exist_ok=True)
    options.tools = options.tools.resolve()
    failed = 0
    for scene in json.loads((HERE / "gallery.json").read_text()):
        if options.scenes and scene["name"] not in options.scenes:
            continue
        needed = [model_of(scene, options), *(options.scenes_dir / name for name in scene.get("needs", []))]
        if not all(path.exists() for path in needed):
            print(f"{scene['name']}: not all of its models are in {options.scenes_dir}; skipped")
            continue
        try:
            print(line(scene["name"], render(scene, options)), flush=True)
        except RuntimeError as error:
            failed += 1
            print(f"{scene['name']}: {error}", file=sys.stderr)
    return 1 if failed else 0


if __name__ == "__main__":
    sys.exit(main())
