"""Puts what the steps reported into thesis.csv, a row for each case of cases.csv: collect.py OUT"""
import json
import pathlib
import re
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import csv_files  # noqa: E402


def row(load, scene, atlas, kernel, size):
    """Without errors if it is the picture that others are compared with, or could not be compared."""
    picture = f"{scene}-{atlas}-{kernel}-{size}"
    built, seen, traced = load(f"{scene}-{atlas}"), load(f"{scene}-{atlas}-seen"), load(picture)
    structure, grid = re.fullmatch("([a-z]+)([0-9]*)", atlas).groups()
    proximity = seen["distances"] if structure == "cloud" else {"max": "", "mean": ""}
    try:
        layers = {layer["name"]: layer for layer in load(f"{picture}-errors")["pairs"][0]["layers"]}
        rmse, differing = layers["color"]["rmse"], layers["id"]["over"][0]["fraction"]
    except FileNotFoundError:
        rmse = differing = ""
    return {
        "scene": scene, "triangles": seen["triangles"], "structure": structure, "built": seen["structure"],
        "grid": grid, "kernel": kernel, "size": size, "ms": traced["gpuMs"], "min_ms": traced.get("minMs", ""),
        "passes": traced.get("repeat", 1), "rays": traced["raysTotal"], "steps_per_ray": traced["stepsPerRay"],
        "tests_per_ray": traced["testsPerRay"], "proximity_max": proximity["max"], "proximity_mean": proximity["mean"],
        "empty": 1.0 - seen["occupiedVolume"], "structure_bytes": built["structureBytes"], "rmse": rmse,
        "ids_differing": differing, "device": traced["device"],
    }  # fmt: skip


def collect(out):
    """The rows; what is not there is told."""
    for case in csv_files.read(out / "cases.csv"):
        try:
            yield row(lambda name: json.loads((out / f"{name}.json").read_text()), **case)
        except FileNotFoundError as error:
            print(f"not measured: {' '.join(case.values())}, {error.filename} is not there", file=sys.stderr)


if __name__ == "__main__":
    folder = pathlib.Path(sys.argv[1])
    rows = list(collect(folder)) or sys.exit("nothing was measured")
    csv_files.write(folder / "thesis.csv", rows)
