"""Draws what collect.py has put together, the counterparts of the thesis' figures 4 to 8, and writes its tables:
figures.py OUT [README.md, of which the tables are replaced and beside which the pictures are put]"""
import math
import pathlib
import re
import shutil
import sys

sys.path.insert(0, str(pathlib.Path(__file__).resolve().parents[1]))
import csv_files  # noqa: E402
import plot  # noqa: E402

SPARSE = "sparse"
FIGURES = {256: "Figure 5", 512: "Figure 6", 1024: "Figure 7"}
KERNELS = {"compute": "compute shaders, the usual way", "multipass": "three fragment shaders, pass after pass, as in the thesis"}
STRUCTURES = ("uniform", "cloud", "ours")
SHOWN = {
    "scenes.png": "The scenes",
    "times-compute.png": "Milliseconds a picture, compute shaders",
    "times-multipass.png": "Milliseconds a picture, fragment shaders",
    "gain.png": "What empty space gains, in time and in steps",
    "sparse.png": "The sparse scene",
}


class Measured:
    """The rows, by what they are of."""

    def __init__(self, path):
        self.rows = csv_files.read(path)
        self.by_case = {tuple(row[key] for key in ("scene", "structure", "grid", "kernel", "size")): row for row in self.rows}
        self.scenes = self.values("scene")
        self.kernels = [kernel for kernel in KERNELS if kernel in self.values("kernel")]
        self.sizes = sorted(self.values("size"), key=int)
        self.device = " and ".join(self.values("device"))

    def values(self, key, **where):
        return plot.unique(row[key] for row in self.rows if all(row[k] == v for k, v in where.items()))

    def cases(self):
        """(scene, grid of the thesis' structures) of all that was measured."""
        return [(scene, grid) for scene in self.scenes for grid in self.values("grid", scene=scene) if grid]

    def number(self, key, case, structure, kernel=None, size=None):
        """NaN where it was not measured. Ours has a grid of its own; by itself it is the first kernel's largest picture."""
        scene, grid = case
        own = "" if structure == "ours" else grid
        row = self.by_case.get((scene, structure, own, kernel or self.kernels[0], size or self.sizes[-1]))
        return float(row[key]) if row and row[key] else math.nan

    def gain(self, case, structure, kernel=None, key="ms"):
        """How many times as much uniform takes."""
        return self.number(key, case, "uniform", kernel) / self.number(key, case, structure, kernel)


def times(measured, kernel):
    """A panel for each size: milliseconds of each scene and structure."""
    panels = []
    for size in measured.sizes:
        rows = [row for row in measured.rows if row["kernel"] == kernel and row["size"] == size and row["scene"] != SPARSE]
        values = {(row["scene"], row["structure"]): float(row["ms"]) for row in rows}
        panels.append(plot.Panel(f"{FIGURES.get(int(size), 'Times')}: {size}x{size}", "ms a frame", values))
    return panels


def gains(measured):
    cases = [case for case in measured.cases() if case[0] != SPARSE]
    panels = []
    for structure in ("cloud", "ours"):
        values = {(case[0], f"time, {kernel}"): measured.gain(case, structure, kernel) for case in cases for kernel in measured.kernels}
        values |= {(case[0], "steps per ray"): measured.gain(case, structure, key="steps_per_ray") for case in cases}
        panels.append(plot.Panel(f"{structure}: how many times as much uniform takes, {measured.sizes[-1]}x{measured.sizes[-1]}", "times", values))
    return panels


def sparse(measured):
    """Clusters are grids; ours has one of its own."""
    rows = [row for row in measured.rows if row["scene"] == SPARSE and row["size"] == measured.sizes[-1]]
    shown = [(f"Figure 8: time, {kernel}", "ms a frame", "ms", kernel) for kernel in measured.kernels]
    shown.append(("Steps", "steps per ray", "steps_per_ray", measured.kernels[0]))
    panels = []
    for title, unit, key, kernel in shown:
        values = {(f"{row['grid']}^3" if row["grid"] else "its own", row["structure"]): float(row[key])
                  for row in rows if row["kernel"] == kernel and row[key]}  # fmt: skip
        panels.append(plot.Panel(title, unit, values))
    return panels


def all_figures(measured):
    found = {f"times-{kernel}": (f"{kernel}: {KERNELS[kernel]}; {measured.device}", times(measured, kernel)) for kernel in measured.kernels}
    found["gain"] = (f"What empty space gains, {measured.device}", gains(measured))
    return found | {"sparse": (f"Sparse scene, {measured.device}", sparse(measured))}


def contact_sheet(measured, pictures, path):
    """Figures 4 and 9: a picture of each scene, under its name, four in a row. The paths written: none without pictures."""
    scenes = [scene for scene in measured.scenes if (pictures / f"{scene}-picture.png").exists()]
    if not scenes:
        return []
    columns, side, title = 4, 300, 34
    rows = -(-len(scenes) // columns)
    width, height = columns * side, rows * (side + title)
    lines = [f"set terminal pngcairo size {width},{height} font 'Sans,12' noenhanced", f"set output {plot.quoted(str(path))}",
             "unset key", "unset border", "unset tics", "set size ratio -1", "set multiplot"]  # fmt: skip
    for i, scene in enumerate(scenes):
        left, top = i % columns * side, i // columns * (side + title)
        triangles = int(measured.values("triangles", scene=scene)[0])
        lines += [
            f"set lmargin at screen {(left + 4) / width}", f"set rmargin at screen {(left + side - 4) / width}",
            f"set tmargin at screen {1 - (top + title) / height}", f"set bmargin at screen {1 - (top + title + side - 8) / height}",
            f"set title {plot.quoted(f'{scene}: {triangles:,} triangles')} offset 0,-0.6",
            f"plot {plot.quoted(str(pictures / f'{scene}-picture.png'))} binary filetype=png with rgbimage",
        ]  # fmt: skip
    return plot.draw_file(path, "\n".join([*lines, "unset multiplot", ""]))


def table(heads, rows):
    lines = [heads, ["---"] + ["---:"] * (len(heads) - 1), *rows]
    return "\n".join("| " + " | ".join(line) + " |" for line in lines)


def shown(value, form):
    return "" if math.isnan(value) else format(value, form)


def less(gain):
    """How much less time that is; below 0: more."""
    return shown(100 * (1 - 1 / gain), ".0f") + " %"


def three(measured, key, case, form, structures=STRUCTURES):
    return " / ".join(shown(measured.number(key, case, structure), form) for structure in structures)


def scene_table(measured):
    heads = ["scene", "triangles", "grid", "empty", "proximity, most", "mean", "steps per ray: uniform / cloud / ours",
             "tests per ray: uniform and cloud / ours", "kB: uniform and cloud / ours", "ours is"]  # fmt: skip
    lines = []
    for case in measured.cases():
        kilobytes = [shown(measured.number("structure_bytes", case, structure) / 1e3, ",.0f") for structure in STRUCTURES[1:]]
        lines.append([
            case[0], f"{int(measured.values('triangles', scene=case[0])[0]):,}", f"{case[1]}³",
            shown(100 * measured.number("empty", case, "cloud"), ".1f") + " %",
            shown(measured.number("proximity_max", case, "cloud"), ".0f"),
            shown(measured.number("proximity_mean", case, "cloud"), ".1f"),
            three(measured, "steps_per_ray", case, ".1f"), three(measured, "tests_per_ray", case, ".1f", STRUCTURES[1:]),
            " / ".join(kilobytes), *measured.values("built", scene=case[0], structure="ours"),
        ])  # fmt: skip
    return table(heads, lines)


def frames(measured, case, kernel, size):
    rates = [1e3 / measured.number("ms", case, structure, kernel, size) for structure in STRUCTURES]
    return "" if all(map(math.isnan, rates)) else " / ".join(shown(rate, ",.0f" if rate >= 100 else ".1f") for rate in rates)


def frames_table(measured, kernel):
    heads = ["frames per second: uniform / cloud / ours", "grid", *(f"{size}²" for size in measured.sizes),
             f"cloud takes less time than uniform by, {measured.sizes[-1]}²", "ours"]  # fmt: skip
    return table(heads, [
        [case[0], f"{case[1]}³", *(frames(measured, case, kernel, size) for size in measured.sizes),
         less(measured.gain(case, "cloud", kernel)), less(measured.gain(case, "ours", kernel))]
        for case in measured.cases()
    ])  # fmt: skip


def found(measured, cases, of_case):
    """What there is of the cases, each under its scene's name if there are several."""
    return ", ".join(f"{case[0]} {of_case(case)}" if len(cases) > 1 else of_case(case) for case in cases)


def findings_table(measured):
    """What the thesis says, and the same of ours. Times are those of the largest pictures, as its."""
    sides = {side: [case for case in measured.cases() if case[1] == side and case[0] != SPARSE] for side in ("32", "64", "128")}
    sparse_at = {side: [case for case in measured.cases() if case == (SPARSE, side)] for side in ("32", "128")}
    said = [
        ("sparse scene, 32³", sparse_at["32"], "37 %", "24"),
        ("sparse scene, 128³", sparse_at["128"], "more than 50 %", "96"),
        ("scenes of fewer triangles, 32³ here", sides["32"], "no significant gain", "not told"),
        ("scene of 36,352 triangles, 64³", sides["64"], "not noticeable", "32"),
        ("scenes of more triangles, 128³", sides["128"], "significant", "63"),
    ]
    heads = ["", "thesis: cloud takes less time by", *measured.kernels, "thesis: greatest proximity", "here"]
    lines = []
    for name, cases, gain, proximity in said:
        gains = [found(measured, cases, lambda case, kernel=kernel: less(measured.gain(case, "cloud", kernel))) for kernel in measured.kernels]
        here = found(measured, cases, lambda case: shown(measured.number("proximity_max", case, "cloud"), ".0f"))
        lines.append([name, gain, *gains, proximity, here])
    return table(heads, [line for line in lines if line[-1]])


def tables(measured):
    parts = [f"Measured on {measured.device}.", findings_table(measured), scene_table(measured)]
    for kernel in measured.kernels:
        parts += [f"{kernel}: {KERNELS[kernel]}.", frames_table(measured, kernel)]
    return "\n\n".join(parts) + "\n"


def write(out):
    """tables.md, and the pictures where there is gnuplot; their paths."""
    out = pathlib.Path(out)
    measured = Measured(out / "thesis.csv")
    (out / "tables.md").write_text(tables(measured), encoding="utf-8")
    return [out / "tables.md", *contact_sheet(measured, out, out / "scenes.png"),
            *plot.draw(all_figures(measured), out)]  # fmt: skip


def update_page(out, page):
    """Puts the tables and the pictures between the page's marks, and the pictures' files beside it."""
    drawn = [name for name in SHOWN if (out / name).exists()]
    for name in drawn:
        shutil.copy(out / name, page.parent / name)
    found = (out / "tables.md").read_text(encoding="utf-8") + "\n" + "".join(f"![{SHOWN[name]}]({name})\n" for name in drawn)
    marks = re.compile(r"(<!-- tables -->\n).*(<!-- end of tables -->)", re.DOTALL)
    text = page.read_text(encoding="utf-8")
    page.write_text(marks.sub(lambda m: f"{m[1]}{found}{m[2]}", text), encoding="utf-8")


if __name__ == "__main__":
    print(*write(sys.argv[1]), sep="\n")
    if len(sys.argv) > 2:
        update_page(pathlib.Path(sys.argv[1]), pathlib.Path(sys.argv[2]))
