"""Draws errors.csv and pictures.csv of a folder, and writes errors.html, one page of it all."""
import html
import re

import csv_files
import error_plot

PAGE = """<!DOCTYPE html>
<html lang="en">
<head>
<meta charset="utf-8">
<meta name="viewport" content="width=device-width, initial-scale=1">
<title>rt-trace: time against error</title>
<style>
:root { color-scheme: light dark; --text: #1c1c1c; --page: #ffffff; --line: #d0d0d0; --head: #f0f0f0; }
@media (prefers-color-scheme: dark) { :root { --text: #e4e4e4; --page: #17191c; --line: #3c4046; --head: #26292e; } }
body { font: 15px/1.45 sans-serif; color: var(--text); background: var(--page); margin: 2em; }
figure { margin: 1em 0; overflow-x: auto; }
figure svg { background: #ffffff; border-radius: 6px; max-width: 100%; height: auto; min-width: 700px; }
.table { overflow: auto; max-height: 70vh; border: 1px solid var(--line); }
table { border-collapse: collapse; font-size: 13px; white-space: nowrap; font-variant-numeric: tabular-nums; }
th, td { padding: 3px 9px; border-bottom: 1px solid var(--line); text-align: left; }
td.number { text-align: right; }
th { position: sticky; top: 0; background: var(--head); padding: 0; }
th button { font: inherit; font-weight: bold; color: inherit; background: none; border: 0; padding: 5px 9px; cursor: pointer; }
th[aria-sort=ascending] button::after { content: " \\2191"; }
th[aria-sort=descending] button::after { content: " \\2193"; }
</style>
</head>
<body>
<h1>Time against error</h1>
<p>Errors are relative to rt-trace's own result with <code>--precision double --intersect watertight</code>.
A click on a column's head sorts by it, another one the other way round.</p>
<!-- contents -->
<script>
for (const button of document.querySelectorAll("th button"))
    button.addEventListener("click", () => {
        const head = button.parentElement, row = head.parentElement, body = row.closest("table").tBodies[0];
        const column = [...row.cells].indexOf(head);
        const down = head.getAttribute("aria-sort") === "ascending";
        for (const cell of row.cells) cell.removeAttribute("aria-sort");
        head.setAttribute("aria-sort", down ? "descending" : "ascending");
        const compare = (a, b) => {
            const x = a.cells[column].textContent, y = b.cells[column].textContent;
            if (x === "" || y === "") return (x === "") - (y === ""); // what was not measured stays last
            const order = isNaN(x) || isNaN(y) ? x.localeCompare(y) : x - y;
            return down ? -order : order;
        };
        body.append(...[...body.rows].sort(compare));
    });
</script>
</body>
</html>
"""


def is_number(text):
    try:
        float(text)
    except ValueError:
        return False
    return True


def cell(text):
    return f'<td{" class=number" if is_number(text) else ""}>{html.escape(text)}</td>'


def table(path):
    rows = csv_files.read(path)
    if not rows:
        return "<p>Nothing was measured.</p>"
    heads = "".join(f'<th><button type="button">{html.escape(column)}</button></th>' for column in rows[0])
    lines = "\n".join(f"<tr>{''.join(map(cell, row.values()))}</tr>" for row in rows)
    return f'<div class="table"><table>\n<thead><tr>{heads}</tr></thead>\n<tbody>\n{lines}\n</tbody>\n</table></div>'


def inline_svg(path, drawn):
    """The picture as part of a page: no XML header, no name spaces, ids that are unique beside another picture's."""
    if path not in drawn:
        return "<p>Not drawn.</p>"
    text = path.read_text(encoding="utf-8")
    text = re.sub(r"\sxmlns(:\w+)?=(\"[^\"]*\"|'[^']*')", "", text[text.index("<svg") :])
    text = re.sub(r"(\bid=['\"]|href=['\"]#|url\(['\"]?#)", rf"\1{path.stem}-", text)
    return f"<figure>\n{text}\n</figure>"


def write(folder):
    """Draws where there is gnuplot; the paths of the page and of the plots."""
    errors, pictures, page = folder / "errors.csv", folder / "pictures.csv", folder / "errors.html"
    drawn = error_plot.draw(errors, pictures, folder)
    parts = ["<h2>Ray queries</h2>", inline_svg(folder / "errors.svg", drawn), table(errors)]
    parts += ["<h2>Pictures</h2>", inline_svg(folder / "pictures.svg", drawn), table(pictures)]
    page.write_text(PAGE.replace("<!-- contents -->", "\n".join(parts)), encoding="utf-8")
    return [page, *drawn]
