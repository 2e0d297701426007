"""The steps of a run over time, as SVG: a lane for each device and host."""
import html

WIDTH, LEFT, ROW = 1000, 190, 18
COLORS = {"import": "#8a6fb8", "grid": "#4d86c4", "trace": "#d98b2b", "merge": "#3f9c8f", "compare": "#7d9a3a"}
FAILED = "#c0392b"


def gantt(statuses, run_start):
    """Without what ran before the run began."""
    bars = [(status, attempt) for status in statuses for attempt in status.attempts
            if attempt["start"] >= run_start and (attempt["end"] or status.state == "running")]  # fmt: skip
    if not bars:
        return "<p>No step ran.</p>"
    begin = min(attempt["start"] for _, attempt in bars)
    end = max(attempt.get("end") or attempt["start"] for _, attempt in bars)
    scale = (WIDTH - LEFT - 10) / max(end - begin, 1e-3)
    lanes = lanes_of(bars)
    height = ROW * (sum(len(rows) for rows in lanes.values()) + 2)
    parts = [f'<svg viewBox="0 0 {WIDTH} {height}" role="img" aria-label="Steps over time">', axis(end - begin, scale, height)]
    y = ROW
    for name in sorted(lanes):
        parts.append(f'<text x="4" y="{y + 13}">{html.escape(name)}</text>')
        for row in lanes[name]:
            parts += [bar(status, attempt, begin, scale, y) for status, attempt in row]
            y += ROW
    return "\n".join([*parts, "</svg>"])


def lanes_of(bars):
    """{host and device: rows of bars that do not overlap}."""
    lanes = {}
    for status, attempt in sorted(bars, key=lambda item: item[1]["start"]):
        rows = lanes.setdefault(f"{attempt['host']} {attempt['slot'] or 'cores'}", [])
        free = next((row for row in rows if (row[-1][1].get("end") or float("inf")) <= attempt["start"]), None)
        if free is None:
            rows.append([(status, attempt)])
        else:
            free.append((status, attempt))
    return lanes


def bar(status, attempt, begin, scale, y):
    end = attempt.get("end") or attempt["start"]
    x, width = LEFT + (attempt["start"] - begin) * scale, max(1.0, (end - attempt["start"]) * scale - 0.5)
    color = FAILED if attempt["exitCode"] else COLORS[status.step.stage]
    title = html.escape(f"{status.step.id}: {end - attempt['start']:.2f} s {attempt['why']}".rstrip())
    return f'<rect x="{x:.1f}" y="{y + 2}" width="{width:.1f}" height="{ROW - 4}" fill="{color}"><title>{title}</title></rect>'


def axis(seconds, scale, height):
    step = next(s for s in (0.1, 0.5, 1, 5, 10, 30, 60, 300, 600, 1800, 3600, 14400, 86400, float("inf")) if seconds / s <= 12)
    marks = [i * step for i in range(13) if i * step <= seconds]
    return "\n".join(
        f'<line x1="{LEFT + t * scale:.1f}" x2="{LEFT + t * scale:.1f}" y1="{ROW}" y2="{height - ROW}"/>'
        f'<text x="{LEFT + t * scale:.1f}" y="{height - 4}" text-anchor="middle">{t:g} s</text>'
        for t in marks
    )
