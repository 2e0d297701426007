"""Makes the tables of a folder that run.sh measured into, draws them and lists what failed: collect.py FOLDER"""
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import csv_files  # noqa: E402
import error_page  # noqa: E402
import plot  # noqa: E402
import plot_results  # noqa: E402

# Columns, and which report has their figures where SCENE.TABLE.csv, which CMake writes, does not say it.
CASE = "scene triangles=rays.triangles structure options"
CLASSES = "ties=compared.ties near_ties=compared.nearTies grazing=compared.grazing edges=compared.edges " \
    "lost=compared.lost extra=compared.extra wrong=compared.wrong"  # fmt: skip
SPREAD = " ".join(
    f"{column}_{part}=compared.{name}.{part}"
    for column, name in (("t", "tRelative"), ("position", "positionDiagonals"), ("normal", "normalRadians"))
    for part in ("median", "p999", "max")
)
TABLES = {
    "results": f"""{CASE} built=grid.structure set rays=compared.rays hits=trace.hits mrays_per_s=trace.mraysPerSecond
        embree_mrays_per_s=embree.embreeMraysPerSecond ratio=trace.ratio {CLASSES} bytes_per_triangle=grid.bytesPerTriangle
        build_mtris_per_s=grid.mtrisPerSecond embree_build_mtris_per_s=rays.embreeBuildMtrisPerSecond threads=rays.threads
        device=trace.device note""",
    "errors": f"""{CASE} bytes_per_triangle=grid.bytesPerTriangle intersect precision set rays=compared.rays
        hits=compared.hits mrays_per_s=trace.mraysPerSecond {SPREAD} wrong_triangle_rate=compared.wrongTriangleRate
        leak_rate=compared.leakRate compared=compared.compared {CLASSES} wrong_triangles=compared.wrongTriangles
        device=trace.device note""",
    "pictures": f"""{CASE} bytes_per_triangle=grid.bytesPerTriangle intersect precision width height spp ms=trace.gpuMs
        rmse=compared.rmse max_error=compared.maxAbs device=trace.device note""",
}


SOFTWARE_LIMIT = "this software renderer"  # rt-trace says so of rays that no other device gives up


def failures(log):
    """{output without its suffix: error} of what ninja said of one scene, one step after the other."""
    found = {}
    for block in re.split(r"^FAILED: ", log, flags=re.MULTILINE)[1:]:
        output = next(word for word in block.split() if not word.startswith("["))
        error = re.search(r".*: error: .*", block)
        found[output.rsplit(".", 1)[0]] = error[0] if error else f"{output} could not be made"
    return found


def reports_of(folder, row):
    """What the steps of a row reported, {} for those that did not."""
    step = row["step"]
    files = {"rays": f"{row['scene']}/rays", "grid": row["atlas"], "trace": step, "compared": f"{step}-compared"}
    paths = {name: folder / f"{file}.json" for name, file in files.items()}
    reports = {name: json.loads(path.read_text()) if path.exists() else {} for name, path in paths.items()}
    embree = reports["rays"].get("sets", {}).get(row.get("set"), {})
    grid, trace, compared = reports["grid"], reports["trace"], reports["compared"]
    if grid:
        grid["mtrisPerSecond"] = grid["trianglesPerSecond"] * 1e-6
    if embree and "mraysPerSecond" in trace:
        trace["ratio"] = trace["mraysPerSecond"] / embree["embreeMraysPerSecond"]
    if "pairs" in compared:
        compared = next(layer for layer in compared["pairs"][0]["layers"] if layer["name"] == "color")
    return reports | {"embree": embree, "compared": compared}


def fault(row, reports, failed):
    """What went wrong in a row, and with what; None if nothing did."""
    scene, step = row["scene"], row["step"]
    variant = f"{scene}, {' '.join(filter(None, (row['structure'], row['options'])))}"
    whole = ", ".join([variant, *(row[key] for key in ("set", "intersect", "precision", "spp") if key in row)])
    reference = "-".join(filter(None, (scene, "reference", row.get("set"))))
    made = {scene: scene, f"{scene}/rays": scene, row["atlas"]: variant, reference: scene, f"{reference}-small": scene}
    for output, what in (made | {step: whole, f"{step}-small": whole, f"{step}-compared": whole}).items():
        if output in failed:
            return what, failed[output]
    compared = reports["compared"]
    if not compared:
        return whole, f"not measured, see {scene}.log"
    if compared.get("verdict") == "fail":
        return whole, ", ".join(f"{compared[key]} {key}" for key in ("lost", "extra", "wrong"))
    return None


def figure(reports, source):
    value = reports
    for key in source.split("."):
        value = value.get(key, "")
        if value in ("", None):  # JSON has null where nothing could be measured
            return ""
    return value


def write_table(folder, name):
    """Writes NAME.csv of all scenes, if there are any; the rows, and what went wrong in them."""
    columns = dict(word.split("=") if "=" in word else (word, f"row.{word}") for word in TABLES[name].split())
    rows, faults = [], []
    for path in sorted(folder.glob(f"*.{name}.csv")):
        log = path.with_suffix("").with_suffix(".log")
        if not log.exists():
            print(f"{path.name}: left out, no run has come to this scene yet", file=sys.stderr)
            continue
        failed = failures(log.read_text(errors="replace"))
        for row in csv_files.read(path):
            reports = reports_of(folder, row)
            wrong = fault(row, reports, failed)
            if wrong:
                faults.append(": ".join(wrong))
                row["note"] = wrong[1]
            rows.append({column: figure(reports | {"row": row}, source) for column, source in columns.items()})
    if rows:
        csv_files.write(folder / f"{name}.csv", rows)
    return rows, faults


def main():
    folder = pathlib.Path(sys.argv[1])
    written = {name: write_table(folder, name) for name in TABLES}
    if written["results"][0]:
        found = plot_results.figures(csv_files.read(folder / "results.csv"))
        print(folder / "results.csv", *plot.draw(found, folder), sep="\n")
    if written["errors"][0]:
        print(folder / "errors.csv", folder / "pictures.csv", *error_page.write(folder), sep="\n")
    faults = list(dict.fromkeys(fault for _, of_table in written.values() for fault in of_table))
    for skipped in (fault for fault in faults if SOFTWARE_LIMIT in fault):
        print(f"skipped: {skipped}", file=sys.stderr)
    faults = [fault for fault in faults if SOFTWARE_LIMIT not in fault]
    if faults:
        sys.exit("\n".join([f"{len(faults)} failures:", *faults]))
    if not any(rows for rows, _ in written.values()):
        sys.exit("nothing was measured")


if __name__ == "__main__":
    main()
