"""Prints what a sample of each picture costs: print_table.py FOLDER"""
import json
import pathlib
import sys


def line(name, report):
    samples = report["samples"]["mean"]
    stages = report["deviceStages"]
    whole = sum(stages.values())
    rays = report["raysTotal"] / (report["width"] * report["height"] * samples)
    return (f"{name:20} {report['atlas']['triangles']:>9,} triangles {report['gpuMs'] / samples:9.2f} ms a sample "
            f"{rays:6.2f} rays a sample {report['mraysPerSecond']:8.1f} Mrays/s "
            f"({', '.join(f'{name[:-2]} {100 * ms / whole:.0f} %' for name, ms in stages.items())})")  # fmt: skip


if __name__ == "__main__":
    pictures = sorted(pathlib.Path(sys.argv[1]).glob("*.png")) or sys.exit(f"{sys.argv[1]}: no pictures")
    for picture in pictures:
        print(line(picture.stem, json.loads(picture.with_suffix(".json").read_text())))
