"""results.csv as bars: rays.{svg,png} and build.{svg,png}."""
from plot import PEER, Panel, unique

SETS = {
    "primary": "Primary rays",
    "shadow": "Shadow rays (any hit)",
    "diffuse": "Diffuse rays",
    "random": "Diffuse rays in random order",
}


def series_of(row):
    return " ".join(filter(None, (row["structure"], row["options"].replace("--quality ", ""))))


def figures(rows):
    """{file name: (heading, panels)} of what was measured."""
    measured = [row for row in rows if row["mrays_per_s"]]
    built = [row for row in rows if row["build_mtris_per_s"]]
    threads = " or ".join(unique(row["threads"] for row in rows))
    devices = " and ".join(unique(row["device"] for row in measured))
    rays = []
    for name, title in SETS.items():
        here = [row for row in measured if row["set"] == name]
        values = {(row["scene"], PEER): float(row["embree_mrays_per_s"]) for row in here}
        values |= {(row["scene"], series_of(row)): float(row["mrays_per_s"]) for row in here}
        rays.append(Panel(title, "Mrays/s", values))
    speed = {(row["scene"], PEER): float(row["embree_build_mtris_per_s"]) for row in built}
    speed |= {(row["scene"], series_of(row)): float(row["build_mtris_per_s"]) for row in built}
    size = {(row["scene"], series_of(row)): float(row["bytes_per_triangle"]) for row in built}
    build = [
        Panel("Build", "Mtriangles/s", speed),
        Panel("Size of the atlas, triangles included", "bytes per triangle", size),
    ]
    return {
        "rays": (f"Ray queries on {devices}, Embree on {threads} threads", rays),
        "build": (f"Builds on {threads} threads", build),
    }
