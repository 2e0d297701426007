"""Draws errors.{svg,png} and pictures.{svg,png} with gnuplot, for error_page.py."""
import math

import csv_files
from plot import TERMINALS, draw_file, quoted, unique
from plot_results import series_of

COLORS = {"watertight": "#004488", "moller-trumbore": "#cc6600", "baldwin-webber": "#228833"}
SHAPES = ((7, 6), (5, 4), (9, 8), (11, 10), (13, 12), (15, 14))  # filled and hollow: circle, square, triangle, ...
LEFT, TOP = 75, 105


class Axis:
    """Logarithmic, in decades; values of 0 stand at its floor, well below all others, where it says 0."""

    def __init__(self, values):
        positive = [value for value in values if 0.0 < value < math.inf]
        self.only_zero = not positive
        self.low = math.log10(min(positive, default=1.0))
        self.high = math.log10(max(positive, default=1.0))
        self.step = max(1, math.ceil((self.high - self.low) / 4))
        self.has_zero = any(value == 0.0 for value in values)
        self.floor = math.floor(self.low) - self.step if self.has_zero else self.low

    def place(self, value):
        return value if value > 0.0 else 10.0**self.floor

    def ticks(self):
        """(label, decade) of the positive ones: powers of ten, or where there are few 1, 2, 5, 10, ..."""
        first, last = math.floor(self.low), math.ceil(self.high)
        if last - first > 2 or self.has_zero:
            return [(f"1e{decade}", decade) for decade in range(first, last + 1, self.step) if decade < self.high + 0.3]
        numbers = [digit * 10.0**decade for decade in range(first - 1, last + 1) for digit in (1, 2, 5)]
        return [(f"{number:g}", math.log10(number)) for number in numbers]

    def commands(self, name):
        ticks = [] if self.only_zero else self.ticks()
        if self.has_zero:
            ticks.insert(0, ("0", self.floor))
        margin = 0.2 + 0.03 * (self.high - self.floor)  # keeps points off the frame
        high = self.floor + 1 if self.only_zero else self.high + margin
        marks = ", ".join(f"'{label}' {10.0**decade:g}" for label, decade in ticks)
        return [
            f"set logscale {name}",
            f"set {name}range [{10.0 ** (self.floor - margin):g}:{10.0**high:g}]",
            f"set {name}tics nomirror ({marks})",
        ]


class Errors:
    """A row of panels for each scene and set: speed against each kind of error."""

    name = "errors"
    panel_width, panel_height = 330, 290
    kinds = (
        ("t_p999", "error in t, relative"),
        ("position_p999", "error in position, of the scene's diagonal"),
        ("normal_p999", "error in the normal, radians"),
        ("faults", "lost or of a wrong triangle, per hit"),
    )
    notes = (
        "Errors: 99.9 % of the hits are no farther off. Grey: the best that there is, the Pareto front.",
        "An error of exactly 0 stands at the tick 0.",
    )

    def __init__(self, rows):
        self.rows = [row | {"faults": fault_rate(row)} for row in rows if row["mrays_per_s"]]
        self.shapes = {name: SHAPES[i % len(SHAPES)] for i, name in enumerate(unique(map(series_of, self.rows)))}
        self.axes = {column: Axis(self.values(column, self.rows)) for column, _ in self.kinds}
        self.groups = unique((row["scene"], row["set"]) for row in self.rows)
        self.columns, self.lines = len(self.kinds), len(self.groups)
        devices = " and ".join(unique(row["device"] for row in self.rows))
        self.heading = f"Ray queries: speed against error on {devices}"

    @staticmethod
    def values(column, rows):
        return [float(row[column]) for row in rows if row[column] != ""]

    def keys(self):
        """Of the legend: colours for tests, filled or hollow for precision, shapes for structures."""
        keys = [f"NaN with points pt 7 ps 1.3 lc rgb '{COLORS[name]}' title '{name}'"
                for name in unique(row["intersect"] for row in self.rows)]  # fmt: skip
        keys += [f"NaN with points pt {SHAPES[0][name == 'double']} ps 1.3 lc rgb '#555555' title '{name}'"
                 for name in unique(row["precision"] for row in self.rows)]  # fmt: skip
        keys += [f"NaN with points pt {shape[0]} ps 1.3 lc rgb '#555555' title {quoted(name)}"
                 for name, shape in self.shapes.items()]  # fmt: skip
        return keys + ["NaN with lines lw 2 lc rgb '#b0b0b0' title 'Pareto front'"]

    def panel(self, line, column):
        key, title = self.kinds[column]
        axis = self.axes[key]
        here = [row for row in self.rows if (row["scene"], row["set"]) == self.groups[line] and row[key] != ""]
        speeds = Axis([float(row["mrays_per_s"]) for row in self.rows])
        lines = [*axis.commands("x"), *speeds.commands("y"), f"set xlabel {quoted(title)}"]
        scene, name = self.groups[line]
        lines += [f"set title {quoted(f'{scene}, {name} rays')} offset 0,-0.6" if column == 0 else "unset title"]
        lines += [f"set ylabel {quoted('Mrays/s')}" if column == 0 else "unset ylabel"]
        if not here:
            return [*lines, "plot NaN notitle"]
        points = [(axis.place(float(row[key])), float(row["mrays_per_s"])) for row in here]
        lines += ["$front << EOD", *(f"{x:g} {y:g}" for x, y in pareto_front(points)), "EOD"]
        plots = ["$front with steps lw 2 lc rgb '#b0b0b0' notitle"]
        for i, (row, (x, y)) in enumerate(zip(here, points)):
            shape = self.shapes[series_of(row)][row["precision"] == "double"]
            lines += [f"$point{i} << EOD", f"{x:g} {y:g}", "EOD"]
            plots.append(f"$point{i} with points pt {shape} ps 1.3 lw 1.5 lc rgb '{COLORS[row['intersect']]}' notitle")
        return [*lines, "plot " + ", ".join(plots)]


def fault_rate(row):
    """Lost hits and those of wrong triangles, per hit; empty where there was none to find."""
    if "" in (row["leak_rate"], row["wrong_triangle_rate"]):
        return ""
    return float(row["leak_rate"]) + float(row["wrong_triangle_rate"])


def pareto_front(points):
    """(error, speed) of those that no other one beats in both, by growing error."""
    front = []
    for x, y in sorted(points, key=lambda point: (point[0], -point[1])):
        if not front or y > front[-1][1]:
            front.append((x, y))
    return front


class Pictures:
    """A panel for each scene: error against time, a curve for each test and precision."""

    name = "pictures"
    panel_width, panel_height = 460, 370
    notes = (
        "Numbers: samples per pixel. The reference is the picture in double precision of the most samples:",
        "there only rounding is left. An error of exactly 0, the reference's own, stands at the tick 0.",
    )

    def __init__(self, rows):
        self.rows = [row for row in rows if row["ms"]]
        self.scenes = unique(row["scene"] for row in self.rows)
        self.columns, self.lines = max(2, min(len(self.scenes), 4)), math.ceil(len(self.scenes) / 4)
        self.cases = unique((row["intersect"], row["precision"]) for row in self.rows)
        self.axes = [Axis([float(row[column]) for row in self.rows]) for column in ("ms", "rmse")]
        devices = " and ".join(unique(row["device"] for row in self.rows))
        self.heading = f"Pictures: error against time on {devices}"

    @staticmethod
    def style(case):
        intersect, precision = case
        dash, shape = (2, 6) if precision == "double" else (1, 7)
        return f"with linespoints lw 1.5 dt {dash} pt {shape} ps 0.9 lc rgb '{COLORS[intersect]}'"

    def keys(self):
        return [f"NaN {self.style(case)} title '{' '.join(case)}'" for case in self.cases]

    def panel(self, line, column):
        x, y = self.axes
        lines = [*x.commands("x"), *y.commands("y"), "set xlabel 'milliseconds'"]
        lines += ["set ylabel 'RMSE'" if column == 0 else "unset ylabel"]
        index = line * self.columns + column
        if index >= len(self.scenes):
            return []
        lines.append(f"set title {quoted(self.scenes[index])} offset 0,-0.6")
        plots = []
        here = [row for row in self.rows if row["scene"] == self.scenes[index]]
        for i, case in enumerate(self.cases):
            curve = sorted((row for row in here if (row["intersect"], row["precision"]) == case), key=lambda row: int(row["spp"]))
            if not curve:
                continue
            lines.append(f"$curve{i} << EOD")
            lines += [f"{row['ms']} {y.place(float(row['rmse'])):g} {row['spp']}" for row in curve]
            lines.append("EOD")
            plots.append(f"$curve{i} using 1:2 {self.style(case)} notitle")
            if not any("labels" in p for p in plots):  # the first curve's: those of the others would lie on it
                plots.append(f"$curve{i} using 1:2:3 with labels right offset -0.8,-0.5 font 'Sans,9' notitle")
        return [*lines, "plot " + ", ".join(plots)]


def script(figure, terminal, path):
    """gnuplot's commands: heading, notes, a strip for the legend, panels."""
    width = LEFT + figure.panel_width * figure.columns
    legend_lines = math.ceil(len(figure.keys()) / (2 if figure.columns < 4 else 5))
    top = TOP + 20 * legend_lines
    height = top + figure.panel_height * figure.lines
    lines = [
        f"set terminal {terminal} size {width},{height} font 'Sans,10' noenhanced",
        f"set output {quoted(str(path))}",
        f"set multiplot title {quoted(figure.heading)} font 'Sans,12'",
        *(f"set label {i + 1} {quoted(note)} at screen 0.5, screen {1 - (40 + 16 * i) / height} center"
          for i, note in enumerate(figure.notes)),
        "unset border", "unset tics", "set xrange [0:1]", "set yrange [0:1]",
        f"set key center center horizontal maxrows {legend_lines} width 1 samplen 2",
        "set lmargin at screen 0.02", "set rmargin at screen 0.98",
        f"set tmargin at screen {1 - 65 / height}", f"set bmargin at screen {1 - (top - 25) / height}",
        "plot " + ", ".join(figure.keys()),
        *(f"unset label {i + 1}" for i in range(len(figure.notes))),
        "unset key", "set border 3", "set tics nomirror",
        "set grid linetype 1 linewidth 1 linecolor rgb '#e2e2e2'",
    ]  # fmt: skip
    for line in range(figure.lines):
        for column in range(figure.columns):
            left, above = LEFT + figure.panel_width * column, top + figure.panel_height * line
            lines += [
                f"set lmargin at screen {left / width}",
                f"set rmargin at screen {(left + figure.panel_width - 50) / width}",
                f"set tmargin at screen {1 - above / height}",
                f"set bmargin at screen {1 - (above + figure.panel_height - 75) / height}",
                *figure.panel(line, column),
            ]
    return "\n".join([*lines, "unset multiplot", ""])


def draw(errors, pictures, folder):
    """The files' paths, none without gnuplot or measurements."""
    paths = []
    for figure in (Errors(csv_files.read(errors)), Pictures(csv_files.read(pictures))):
        for suffix, terminal in TERMINALS.items() if figure.rows else ():
            path = folder / f"{figure.name}.{suffix}"
            paths += draw_file(path, script(figure, terminal, path))
    return paths
