"""Prints the quickstart's figures from the JSON files that the tools wrote: print_table.py FOLDER"""
import json
import pathlib
import sys

STRUCTURES = ("uniform", "cloud")
ROWS = ("triangles", "cells", "atlas bytes", "build ms", "render ms", "Mrays/s", "steps per ray", "RMSE")


def load(folder, name):
    return json.loads((folder / f"{name}.json").read_text())


def column(folder, structure, rmse):
    atlas = load(folder, f"{structure}_atlas")
    view = load(folder, f"{structure}_view")
    cells = " x ".join(str(n) for n in atlas["resolution"])
    return (
        f"{atlas['triangles']:,}",
        cells,
        f"{atlas['fileBytes']:,}",
        f"{atlas['buildMs']:.1f}",
        f"{view['gpuMs']:.2f}",
        f"{view['mraysPerSecond']:.2f}",
        f"{view['stepsPerRay']:.2f}",
        rmse,
    )


def main():
    folder = pathlib.Path(sys.argv[1])
    comparison = load(folder, "comparison")
    color = next(layer for layer in comparison["pairs"][0]["layers"] if layer["name"] == "color")
    errors = ("reference", f"{color['rmse']:.3g}")
    columns = [ROWS, *(column(folder, s, e) for s, e in zip(STRUCTURES, errors))]
    heading = ("", *STRUCTURES)
    for cells in zip(*((h, *c) for h, c in zip(heading, columns))):
        print(f"{cells[0]:<14}" + "".join(f"{cell:>18}" for cell in cells[1:]))
    print(f"device         {load(folder, 'cloud_view')['device']}")
    print(f"pictures       {' '.join(str(folder / f'{s}_view.png') for s in STRUCTURES)} (and .exr)")
    print(f"verdict        {comparison['verdict']}: the two renders agree")


if __name__ == "__main__":
    main()
