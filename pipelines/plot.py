"""Bars of several series over scenes, drawn with gnuplot."""
import functools
import math
import shutil
import subprocess
import sys

PEER = "Embree (CPU)"
PEER_COLOR = "#9a9a9a"
COLORS = ("#4477aa", "#66ccee", "#228833", "#ccbb44", "#ee6677", "#aa3377", "#bb5566", "#004488", "#997700")
TERMINALS = {"svg": "svg background '#ffffff'", "png": "pngcairo"}


def quoted(text):
    return "'" + text.replace("'", "''") + "'"


def unique(values):
    return list(dict.fromkeys(values))


def value_range(panels):
    """From the power of ten below all values, with room for the smallest bar, to where labels end above the largest."""
    values = [value for panel in panels for value in panel.values.values()]
    low = math.floor(math.log10(min(values) / 1.5))
    decades = math.log10(max(values)) - low
    return f"[1e{low}:{10.0 ** (low + 1.35 * decades):g}]"


def label(value):
    """Three digits, never an exponent."""
    return f"{float(f'{value:.3g}'):.0f}" if value >= 100.0 else f"{value:.3g}"


class Panel:
    """Clusters of bars, one per scene, one bar per series; values: {(scene, series): number}."""

    def __init__(self, title, unit, values):
        self.title, self.unit = title, unit
        self.values = {key: value for key, value in values.items() if value > 0.0}

    def commands(self, scenes, series, colors, yrange):
        width = len(series) + 1.5
        ticks = ", ".join(
            f"{quoted(scene)} {i * width + (len(series) - 1) / 2}" for i, scene in enumerate(scenes)
        )
        lines, plots = [], []
        for j, name in enumerate(series):
            points = [
                f"{i * width + j} {self.values[scene, name]:.6g} {label(self.values[scene, name])}"
                for i, scene in enumerate(scenes)
                if (scene, name) in self.values
            ]
            if points:
                lines += [f"$bars{j} << EOD", *points, "EOD"]
                plots.append(f"$bars{j} using 1:2 with boxes fillcolor rgb {quoted(colors[name])} notitle")
                plots.append(f"$bars{j} using 1:2:(' '.strcol(3)) with labels rotate left font 'Sans,8' notitle")
        return lines + [
            f"set title {quoted(self.title)} offset 0,-0.5",
            f"set ylabel {quoted(self.unit)} offset graph 0,0",
            f"set yrange {yrange}",
            f"set xrange [-1.25:{len(scenes) * width - 1.25}]",
            f"set xtics ({ticks}) scale 0",
            "plot " + ", ".join(plots),
        ]


def legend(series, colors):
    """An own strip above the panels, so that these are of one height."""
    keys = [f"NaN with boxes fillcolor rgb {quoted(colors[name])} title {quoted(name)}" for name in series]
    return [
        "unset border", "unset tics", "set key center center horizontal width 2", "set xrange [0:1]", "set yrange [1:10]",
        "plot " + ", ".join(keys),
        "set border 3", "set ytics nomirror", "set xtics nomirror", "unset key",
        "set grid ytics linetype 1 linewidth 1 linecolor rgb '#d8d8d8'",
    ]  # fmt: skip


def script(heading, panels, terminal, path):
    """gnuplot's commands. Panels of the same unit have one range, so that they can be compared."""
    scenes = unique(scene for panel in panels for scene, _ in panel.values)
    series = unique(name for panel in panels for _, name in panel.values if name != PEER)
    colors = {name: COLORS[i % len(COLORS)] for i, name in enumerate(series)} | {PEER: PEER_COLOR}
    if any(name == PEER for panel in panels for _, name in panel.values):
        series = [PEER, *series]
    width = min(max(800, 110 + 16 * len(scenes) * (len(series) + 2)), 1900)
    top, panel_height = 80, 265
    height = top + panel_height * len(panels)
    lines = [
        f"set terminal {terminal} size {width},{height} font 'Sans,11' noenhanced",
        f"set output {quoted(str(path))}",
        "set logscale y",
        "set style fill solid 1.0 border rgb '#ffffff'",
        "set boxwidth 1.0",
        f"set multiplot title {quoted(heading)}",
        "set lmargin at screen 0.0",
        "set rmargin at screen 1.0",
        f"set tmargin at screen {1 - 30 / height}",
        f"set bmargin at screen {1 - 75 / height}",
        *legend(series, colors),
        f"set lmargin at screen {100 / width}",
        f"set rmargin at screen {1 - 15 / width}",
    ]
    for i, panel in enumerate(panels):
        below_top = top + panel_height * i
        lines += [
            f"set tmargin at screen {1 - (below_top + 25) / height}",
            f"set bmargin at screen {1 - (below_top + panel_height - 35) / height}",
        ]
        yrange = value_range([p for p in panels if p.unit == panel.unit])
        lines += panel.commands(scenes, series, colors, yrange)
    return "\n".join([*lines, "unset multiplot", ""])


@functools.cache
def has_gnuplot():
    """False, which is said once, where there is none."""
    found = shutil.which("gnuplot") is not None
    if not found:
        print("no plots: gnuplot is not installed", file=sys.stderr)
    return found


def draw_file(path, commands):
    """[path], which these commands write; [] without gnuplot."""
    if not has_gnuplot():
        return []
    subprocess.run(["gnuplot"], input=commands, text=True, check=True)
    return [path]


def draw(figures, folder):
    """Draws {file name: (heading, panels)}, but for panels without values; the files' paths."""
    paths = []
    for name, (heading, panels) in figures.items():
        panels = [panel for panel in panels if panel.values]
        for suffix, terminal in TERMINALS.items() if panels else ():
            path = folder / f"{name}.{suffix}"
            paths += draw_file(path, script(heading, panels, terminal, path))
    return paths
