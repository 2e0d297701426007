"""One page of a run, without any other file but the comparisons' own pages and logs that it links to."""
import base64
import html
import os

from planner.files import parse_json, tail
from planner.gantt import COLORS, FAILED, gantt
from planner.junit import seconds
from planner.run_step import is_time
from planner.status import DONE
from planner.thumbnail import thumbnail

DIFFERS = 1  # rt-compare's exit code
RUN = "run.json"  # when `plan run` began
PIXELS = 240
PICTURES = 24  # of one render; of more, evenly many

STYLE = """
body { font: 15px/1.45 system-ui, sans-serif; margin: 2em auto; max-width: 70em; padding: 0 1em; color: #222; }
h1 { margin-bottom: 0; } h2 { margin-top: 1.8em; border-bottom: 1px solid #ccc; }
table { border-collapse: collapse; } td, th { text-align: left; padding: 2px 14px 2px 0; vertical-align: top; }
td.n { text-align: right; font-variant-numeric: tabular-nums; }
figure { display: inline-block; margin: 0 10px 10px 0; } figcaption { font-size: 12px; color: #555; }
svg { width: 100%; font: 11px system-ui, sans-serif; } svg line { stroke: #ddd; }
.failed, .blocked { color: #c0392b; font-weight: 600; } .skipped, .waiting { color: #777; } .done { color: #2e7d32; }
pre { background: #f5f5f5; padding: 8px; overflow: auto; font-size: 12px; } .key { padding: 0 6px; color: #fff; margin-right: 8px; }
"""


def page(graph, folder, statuses, target):
    """`target`: the file that it will be, for its links."""
    by_id = {status.step.id: status for status in statuses}
    base = target.absolute().parent
    sections = [
        ("Comparisons", comparisons(graph, folder, by_id, base)),
        ("Pictures", pictures(graph, folder, by_id)),
        ("Times", gantt(statuses, start_of_run(folder)) + key()),
        ("What failed", failures(folder, statuses)),
        ("Skipped or not run, and why", untouched(statuses, folder)),
        ("Steps", steps(statuses, folder, base)),
    ]
    body = "\n".join(f"<h2>{title}</h2>\n{content}" for title, content in sections if content)
    head = f'<meta charset="utf-8"><meta name="viewport" content="width=device-width"><title>{html.escape(graph.name)}</title>'
    return f'<!DOCTYPE html>\n<html lang="en"><head>{head}<style>{STYLE}</style></head><body>\n{title(graph, statuses)}\n{body}\n</body></html>\n'


def title(graph, statuses):
    counts = {}
    for status in statuses:
        counts[status.state] = counts.get(status.state, 0) + 1
    said = ", ".join(f'<span class="{state}">{count} {state}</span>' for state, count in counts.items())
    return f"<h1>{html.escape(graph.name)}</h1>\n<p>{len(statuses)} steps: {said}; {sum(map(seconds, statuses)):.1f} s of work</p>"


def comparisons(graph, folder, by_id, base):
    rows = [comparison(name, item, folder, by_id[item["step"]], base) for name, made in graph.comparisons.items() for item in made]
    header = "<tr><th>name<th>verdict<th>picture<th>against<th>figures<th></tr>"
    return f"<table>{header}{''.join(rows)}</table>" if rows else ""


def comparison(name, item, folder, status, base):
    verdict = {"done": "pass", "skipped": "pass", "failed": "fail"}.get(status.state, status.state)
    has_compared = status.state in DONE or (status.state == "failed" and status.attempts[-1]["exitCode"] == DIFFERS)  # else what is there is older
    shown = link(folder / item["page"], base, "page") if has_compared and (folder / item["page"]).exists() else ""
    against = "golden" if item["golden"] else status.step.argv[2]
    cells = [html.escape(name), f'<span class="{status.state}">{verdict}</span>', html.escape(item["exr"]), html.escape(against),
             html.escape(figures(folder / item["figures"])) if has_compared else "", shown]  # fmt: skip
    return "<tr>" + "".join(f"<td>{cell}</td>" for cell in cells) + "</tr>"


def figures(path):
    """What rt-compare says of the colours, or nothing."""
    try:
        pair = parse_json(path.read_text(encoding="utf-8"))["pairs"][0]
        layer = next(layer for layer in pair["layers"] if layer["name"] == "color")
        return f"RMSE {layer['rmse']:.4g}"
    except (OSError, ValueError, LookupError, TypeError, StopIteration):
        return ""


def pictures(graph, folder, by_id):
    parts = []
    for name, made in graph.renders.items():
        shown = made[:: -(-len(made) // PICTURES)]
        figures_of = [picture(folder, item, by_id) for item in shown]
        note = f" ({len(shown)} of {len(made)})" if len(shown) < len(made) else ""
        parts.append(f"<h3>{html.escape(name)}{note}</h3>\n{''.join(figures_of)}")
    return "\n".join(parts)


def picture(folder, item, by_id):
    stem = item["exr"].removesuffix(".exr")
    state = by_id[item["step"]].state
    caption = html.escape(os.path.basename(stem)) + ("" if state in DONE else f": {state}")
    try:
        small = thumbnail((folder / f"{stem}.png").read_bytes(), PIXELS)
    except OSError:
        small = None
    if small is None:
        return f"<figure><figcaption>{caption}</figcaption></figure>"
    data = base64.b64encode(small).decode()
    return f'<figure><img alt="{caption}" src="data:image/png;base64,{data}"><figcaption>{caption}</figcaption></figure>'


def key():
    colors = [*COLORS.items(), ("failed or cut off", FAILED)]
    return "<p>" + "".join(f'<span class="key" style="background:{color}">{name}</span>' for name, color in colors) + "</p>"


def failures(folder, statuses):
    return "\n".join(f"<h3>{s.step.id}</h3><p>{html.escape(s.why)}</p><pre>{html.escape(tail(folder / s.step.log, 12))}</pre>"
                     for s in statuses if s.state == "failed")  # fmt: skip


def untouched(statuses, folder):
    begin = start_of_run(folder)
    rows = [(s.step.id, s.state, s.why) for s in statuses if s.state in ("skipped", "waiting", "blocked")]
    rows += [(s.step.id, "not started", "nothing that it depends on has changed since an earlier run")
             for s in statuses if s.state == "done" and s.attempts[-1]["end"] < begin]  # fmt: skip
    cells = "".join(f"<tr><td>{id}</td><td>{state}</td><td>{html.escape(why)}</td></tr>" for id, state, why in rows)
    return f"<table>{cells}</table>" if rows else ""


def start_of_run(folder):
    """When `plan run` began; 0 of other engines, of which nobody knows when they began."""
    try:
        start = parse_json((folder / RUN).read_text(encoding="utf-8"))["start"]
    except (OSError, ValueError, KeyError, TypeError):
        return 0
    return start if is_time(start) else 0


def steps(statuses, folder, base):
    rows = "".join(
        f'<tr><td>{s.step.id}</td><td class="{s.state}">{s.state}</td><td class="n">{seconds(s):.2f} s</td>'
        f'<td class="n">{len(s.attempts)}</td><td>{html.escape(place(s))}</td><td>{log_link(s, folder, base)}</td></tr>'
        for s in statuses
    )
    return f"<details><summary>all {len(statuses)}</summary><table><tr><th>step<th>state<th>time<th>attempts<th>on<th></tr>{rows}</table></details>"


def place(status):
    return f"{status.attempts[-1]['host']} {status.attempts[-1]['slot']}".strip() if status.attempts else ""


def log_link(status, folder, base):
    return link(folder / status.step.log, base, "log") if (folder / status.step.log).exists() else ""


def link(path, base, text):
    return f'<a href="{html.escape(os.path.relpath(path.absolute(), base))}">{text}</a>'
