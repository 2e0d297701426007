"use strict";
// Draws the page from the JSON in #data: `report`, a pair as --json gives it, and `layers`, whose planes are
// half floats (pictures) or bytes (maps): along each row the difference to the left neighbour, all high bytes before all low ones,
// compressed, in base64. Texts only ever enter the page as text nodes.
const data = JSON.parse(document.getElementById("data").textContent);
const report = data.report;
const byId = id => document.getElementById(id);

function element(tag, text, attributes = {}) {
  const made = document.createElement(tag);
  if (text !== undefined) made.textContent = text;
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  return made;
}
function number(value) {
  if (value === null || value === undefined) return "–";
  if (typeof value !== "number") return String(value);
  return Number.isInteger(value) ? String(value) : Number(value.toPrecision(6)).toString();
}
function table(head, rows) {
  const made = element("table");
  const line = made.createTHead().insertRow();
  for (const title of head) line.append(element("th", title, { scope: "col" }));
  const body = made.createTBody();
  for (const row of rows) body.append(row);
  return made;
}
function row(title, cells, kind = "") {
  const made = element("tr", undefined, { class: kind });
  made.append(element("th", title, { scope: "row" }));
  for (const cell of cells) made.append(cell instanceof Node ? cell : element("td", number(cell)));
  return made;
}

// ---- planes

async function inflate(base64) {
  const bytes = Uint8Array.from(atob(base64), c => c.charCodeAt(0));
  const stream = new Blob([bytes]).stream().pipeThrough(new DecompressionStream("deflate"));
  return new Uint8Array(await new Response(stream).arrayBuffer());
}
async function readHalves(base64, width, height) {
  const bytes = await inflate(base64), count = width * height, halves = new Uint16Array(count);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0, before = 0; x < width; ++x, ++i)
      halves[i] = before = (before + (bytes[i] << 8 | bytes[count + i])) & 0xffff;
  return halves;
}
async function readBytes(base64, width, height) {
  const bytes = await inflate(base64);
  for (let y = 0, i = 0; y < height; ++y)
    for (let x = 0, before = 0; x < width; ++x, ++i) bytes[i] = before = (before + bytes[i]) & 0xff;
  return bytes;
}
const valueOfHalf = (() => {
  const values = new Float32Array(65536);
  for (let h = 0; h < 65536; ++h) {
    const sign = h & 0x8000 ? -1 : 1, exponent = h >> 10 & 31, fraction = h & 1023;
    values[h] = exponent === 31 ? (fraction ? NaN : sign * Infinity)
      : sign * (exponent ? 2 ** (exponent - 15) * (1 + fraction / 1024) : 2 ** -24 * fraction);
  }
  return values;
})();

const encodeSrgb = v => v <= 0.0031308 ? 12.92 * v : 1.055 * v ** (1 / 2.4) - 0.055;
const decodeSrgb = v => v <= 0.04045 ? v / 12.92 : ((v + 0.055) / 1.055) ** 2.4;
const isLinear = data.scale === "linear";
function shown(value, factor) { // 0 to 255 on a screen
  const light = (isLinear ? value : decodeSrgb(Math.max(value, 0))) * factor;
  return Math.round(255 * encodeSrgb(Math.min(Math.max(light, 0), 1)));
}

// ---- what is on the canvas

const kViews = [["split", "Slider"], ["a", "A"], ["b", "B"], ["blink", "Blink"], ["side", "Side by side"],
  ["difference", "|a−b|"], ["flip", "FLIP"], ["heat", "Error map"]];
const kNotFinite = [255, 0, 255];
const state = { layer: 0, view: "split", stops: 0, zoom: 1, x: 0, y: 0, divider: 0.5, isB: false };
const canvas = byId("canvas"), context = canvas.getContext("2d");
let layers = [], pictures = {};

function picture(colorAt) {
  const made = document.createElement("canvas");
  made.width = data.width;
  made.height = data.height;
  const pixels = new ImageData(data.width, data.height), to = pixels.data;
  for (let i = 0; i < data.width * data.height; ++i) {
    const color = colorAt(i);
    to[4 * i] = color[0]; to[4 * i + 1] = color[1]; to[4 * i + 2] = color[2]; to[4 * i + 3] = 255;
  }
  made.getContext("2d").putImageData(pixels, 0, 0);
  return made;
}
function exposed(planes) {
  const factor = 2 ** state.stops, levels = new Uint8Array(65536), bad = new Uint8Array(65536);
  for (let h = 0; h < 65536; ++h) {
    levels[h] = shown(valueOfHalf[h], factor);
    bad[h] = Number.isFinite(valueOfHalf[h]) ? 0 : 1;
  }
  const [r, g, b] = [planes[0], planes[1] || planes[0], planes[2] || planes[0]], color = [0, 0, 0];
  return picture(i => {
    if (bad[r[i]] || bad[g[i]] || bad[b[i]]) return kNotFinite;
    color[0] = levels[r[i]]; color[1] = levels[g[i]]; color[2] = levels[b[i]];
    return color;
  });
}
function differences(a, b) {
  const factor = 2 ** state.stops, color = [0, 0, 0];
  return picture(i => {
    for (let c = 0; c < 3; ++c) {
      const k = a[c] ? c : 0, difference = Math.abs(valueOfHalf[a[k][i]] - valueOfHalf[b[k][i]]);
      if (!Number.isFinite(difference)) return kNotFinite;
      color[c] = 255 * encodeSrgb(Math.min(difference * factor, 1));
    }
    return color;
  });
}
const hot = plane => picture(i => data.heatColors[plane[i]]);
// Made when first shown; expose() forgets those that depend on it.
function pictureOf(kind) {
  const layer = layers[state.layer];
  if (!pictures[kind])
    pictures[kind] = kind === "a" ? exposed(layer.a) : kind === "b" ? exposed(layer.b)
      : kind === "difference" ? differences(layer.a, layer.b) : hot(kind === "flip" ? layer.flip : layer.heat);
  return pictures[kind];
}
function isOffered(view) {
  const layer = layers[state.layer];
  return view === "heat" ? !!layer.heat : view === "flip" ? !!layer.flip : !!layer.a;
}

function drawInto(kind, left, width, height, shift = 0) {
  context.save();
  context.beginPath();
  context.rect(left, 0, width, height);
  context.clip();
  context.imageSmoothingEnabled = state.zoom < 1;
  context.drawImage(pictureOf(kind), shift + state.x, state.y, data.width * state.zoom, data.height * state.zoom);
  context.restore();
}
function label(text, x, color) {
  context.font = "600 14px system-ui, sans-serif";
  context.fillStyle = "#fff";
  context.fillRect(x, 6, context.measureText(text).width + 12, 22);
  context.fillStyle = color;
  context.fillText(text, x + 6, 22);
}
function draw() {
  const width = canvas.clientWidth, height = canvas.clientHeight, ratio = window.devicePixelRatio || 1;
  canvas.width = Math.round(width * ratio);
  canvas.height = Math.round(height * ratio);
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  if (state.view === "split") {
    const at = state.divider * width;
    drawInto("a", 0, at, height);
    drawInto("b", at, width - at, height);
    context.fillStyle = "#fff";
    context.fillRect(at - 1.5, 0, 3, height);
    context.fillRect(at - 6, height / 2 - 16, 12, 32);
    label("A", 6, "#0550ae");
    label("B", width - 32, "#bc4c00");
  } else if (state.view === "side") {
    drawInto("a", 0, width / 2 - 1, height);
    drawInto("b", width / 2 + 1, width / 2 - 1, height, width / 2);
    label("A", 6, "#0550ae");
    label("B", width / 2 + 8, "#bc4c00");
  } else {
    const kind = state.view === "blink" ? (state.isB ? "b" : "a") : state.view;
    drawInto(kind, 0, width, height);
    label(kind.length === 1 ? kind.toUpperCase() : kViews.find(v => v[0] === kind)[1], 6,
      kind === "b" ? "#bc4c00" : "#0550ae");
  }
}
function paneWidth() { return state.view === "side" ? canvas.clientWidth / 2 : canvas.clientWidth; }
function fit() {
  state.zoom = Math.min(paneWidth() / data.width, canvas.clientHeight / data.height);
  if (state.zoom > 1) state.zoom = Math.floor(state.zoom);
  place(data.width / 2, data.height / 2);
}
function place(x, y) { // this pixel in the middle
  state.x = paneWidth() / 2 - x * state.zoom;
  state.y = canvas.clientHeight / 2 - y * state.zoom;
  draw();
}
function zoomAt(x, y, zoom) {
  zoom = Math.min(Math.max(zoom, 1 / 64), 64);
  state.x = x - (x - state.x) * zoom / state.zoom;
  state.y = y - (y - state.y) * zoom / state.zoom;
  state.zoom = zoom;
  draw();
}
function expose(stops) {
  state.stops = stops;
  byId("exposure").value = stops;
  byId("stops").value = number(stops);
  for (const kind of ["a", "b", "difference"]) delete pictures[kind];
  draw();
}
function show(view) {
  if (!isOffered(view)) view = isOffered("split") ? "split" : "heat";
  const wasSide = state.view === "side";
  state.view = view;
  for (const input of document.querySelectorAll("#views input")) {
    input.checked = input.value === view;
    input.disabled = !isOffered(input.value);
  }
  byId("blink-label").hidden = view !== "blink";
  if (wasSide !== (view === "side")) fit(); else draw();
}
function choose(index) {
  state.layer = index;
  pictures = {};
  byId("layer").value = index;
  show(state.view);
  drawHistograms();
}

function readout(x, y) {
  const layer = layers[state.layer];
  if (x < 0 || y < 0 || x >= data.width || y >= data.height) return;
  const i = y * data.width + x, lines = [];
  const values = planes => planes.map(plane => number(valueOfHalf[plane[i]])).join(" ");
  if (layer.a) {
    const difference = layer.a.map((plane, c) => number(valueOfHalf[plane[i]] - valueOfHalf[layer.b[c][i]]));
    lines.push(`a ${values(layer.a)}   b ${values(layer.b)}   a−b ${difference.join(" ")}`);
  }
  const maps = [];
  if (layer.flip) maps.push(`FLIP ${(layer.flip[i] / 255).toFixed(3)}`);
  if (layer.heat) maps.push(`error ${(layer.heat[i] / 255).toFixed(3)} of the largest`);
  byId("readout").textContent =
    [`${layer.name} at x ${data.x0 + x * data.step}, y ${data.y0 + y * data.step}`, ...lines, maps.join("   ")].join("\n");
}

// ---- tables and histograms

const kFigures = [["maxAbs", "max |a−b|"], ["mae", "MAE"], ["rmse", "RMSE"], ["relMse", "relMSE"], ["smape", "sMAPE"],
  ["psnr", "PSNR (dB)"], ["bias", "mean a−b"]];
function drawFigures() {
  const rows = [];
  for (const layer of report.layers) {
    const flip = layer.flip || {};
    if (layer.kind === "ids") {
      for (const channel of layer.channels)
        rows.push(row(`${channel.name} (${channel.differing} pixels differ)`, new Array(kFigures.length + 4).fill(null)));
      continue;
    }
    rows.push(row(layer.name, [...kFigures.map(f => layer[f[0]]), layer.ssim, layer.msSsim, flip.mean, flip.weightedMedian]));
    if (layer.channels.length > 1)
      for (const channel of layer.channels)
        rows.push(row(channel.name, [...kFigures.map(f => channel[f[0]]), null, null, null, null], "channel"));
  }
  const unit = isLinear ? "linear units" : "display units, 0 to 1";
  byId("figures").append(table([unit, ...kFigures.map(f => f[1]), "SSIM", "MS-SSIM", "FLIP mean", "FLIP w. median"], rows));
  for (const layer of report.layers) {
    if (!layer.flip) continue;
    const f = layer.flip;
    const exposures = f.hdr ? `, ${f.exposures} exposures from ${number(f.startExposure)} to ${number(f.stopExposure)} stops` : "";
    byId("figures").append(element("p", `FLIP of ${layer.name}: ${number(f.pixelsPerDegree)} pixels per degree${exposures}` +
      `; weighted quartiles ${number(f.firstWeightedQuartile)} and ${number(f.thirdWeightedQuartile)}, maximum ${number(f.max)}` +
      (f.note ? `; ${f.note}` : ""), { class: "note" }));
  }
}
function drawChecks() {
  byId("limits").hidden = report.checks.length === 0;
  byId("checks").append(table(["layer", "metric", "found", "limit", ""], report.checks.map(check => row(check.where, [
    element("td", check.metric, { class: "text" }), check.value, `${check.atLeast ? "≥" : "≤"} ${number(check.limit)}`,
    element("td", check.passed ? "kept" : "exceeded", { class: check.passed ? "good" : "bad" })]))));
}
function jump(layer, x, y) {
  const index = layers.findIndex(l => l.name === layer);
  if (index >= 0 && index !== state.layer) choose(index);
  const [px, py] = [Math.floor((x - data.x0) / data.step), Math.floor((y - data.y0) / data.step)];
  state.zoom = Math.max(state.zoom, 8);
  place(px + 0.5, py + 0.5);
  readout(px, py);
  canvas.scrollIntoView({ block: "center" });
}
function drawWorst() {
  const rows = [];
  for (const layer of report.layers)
    for (const worst of layer.worst) {
      const button = element("button", `${worst.x}, ${worst.y}`, { type: "button", class: "jump" });
      button.onclick = () => jump(layer.name, worst.x, worst.y);
      const cell = element("td");
      cell.append(button);
      rows.push(row(layer.name, [element("td", worst.channel, { class: "text" }), cell, worst.a, worst.b, worst.a - worst.b]));
    }
  byId("worst").append(rows.length ? table(["layer", "channel", "x, y", "a", "b", "a−b"], rows) : element("p", report.layers.length ? "No pixel differs." : "No pixels were compared."));
}
function svg(tag, attributes, text) {
  const made = document.createElementNS("http://www.w3.org/2000/svg", tag);
  for (const [name, value] of Object.entries(attributes)) made.setAttribute(name, value);
  if (text !== undefined) made.textContent = text;
  return made;
}
// Bars of equal width; heights by the root, so that rare errors stay visible.
function histogram(title, series, labels) {
  const width = 360, height = 130, base = 105, made = element("figure");
  const picture = svg("svg", { width, height, role: "img", "aria-label": title });
  const most = Math.max(1, ...series.flatMap(s => s.counts));
  for (const { counts, color } of series)
    counts.forEach((count, i) => {
      const h = 95 * Math.sqrt(count / most), w = width / counts.length;
      if (count > 0) picture.append(svg("rect", { x: i * w, y: base - h, width: Math.max(w - 1, 1), height: h, fill: color,
        "fill-opacity": series.length > 1 ? 0.5 : 1 }));
    });
  picture.append(svg("line", { x1: 0, y1: base, x2: width, y2: base, stroke: "#57606a" }));
  labels.forEach((text, i) => picture.append(svg("text", { x: width * i / (labels.length - 1), y: base + 16,
    "text-anchor": i === 0 ? "start" : i === labels.length - 1 ? "end" : "middle" }, text)));
  made.append(picture, element("figcaption", `${title} (heights: root of the count)`));
  return made;
}
function brightness(planes) { // bins of a quarter of a stop, from -10 to 6
  const counts = new Array(64).fill(0), [r, g, b] = [planes[0], planes[1] || planes[0], planes[2] || planes[0]];
  for (let i = 0; i < r.length; ++i) {
    const values = [r, g, b].map(plane => isLinear ? valueOfHalf[plane[i]] : decodeSrgb(Math.max(valueOfHalf[plane[i]], 0)));
    const light = 0.2126 * values[0] + 0.7152 * values[1] + 0.0722 * values[2];
    if (light > 0 && Number.isFinite(light)) ++counts[Math.min(Math.max(Math.floor((Math.log2(light) + 10) * 4), 0), 63)];
  }
  return counts;
}
function drawHistograms() {
  const layer = layers[state.layer], figures = report.layers.find(l => l.name === layer.name), made = [];
  if (layer.a) made.push(histogram("Brightness of A (blue) and B (orange), stops",
    [{ counts: brightness(layer.a), color: "#0550ae" }, { counts: brightness(layer.b), color: "#bc4c00" }], ["−10", "−6", "−2", "2", "6"]));
  if (figures && figures.histogram) {
    const counts = figures.histogram.counts, low = figures.histogram.lowestExponent, half = Math.floor((counts.length - 1) / 2);
    const title = `|a−b|, powers of two; ${counts[0]} of ${figures.compared} values are equal`;
    made.push(histogram(title, [{ counts: counts.slice(1), color: "#6639ba" }], [`2^${low}`, `2^${low + half}`, `2^${low + counts.length - 1}`]));
  }
  if (layer.flipHistogram) made.push(histogram("FLIP", [{ counts: layer.flipHistogram, color: "#1a7f37" }], ["0", "0.25", "0.5", "0.75", "1"]));
  byId("histograms").replaceChildren(...made);
}
function drawTexts() {
  const verdict = byId("verdict");
  verdict.textContent = report.verdict;
  verdict.className = report.verdict;
  byId("names").textContent = `A ${report.a.file} against B ${report.b.file}`;
  for (const finding of report.findings)
    byId("findings").append(element("li", (finding.fails ? "" : "allowed: ") + finding.text, { class: finding.fails ? "fails" : "" }));
  for (const note of report.notes) byId("notes").append(element("li", note));
  const parts = p => p.parts.map(part => `${part.dataWindow[2] - part.dataWindow[0]} × ${part.dataWindow[3] - part.dataWindow[1]}: ` +
    part.channels.join(" ")).join("; ");
  byId("files").append(table(["", "file", "format", "pixels and channels", "NaN", "+Inf", "−Inf"], [["A", report.a], ["B", report.b]].map(([name, p]) =>
    row(name, [p.file, p.format, parts(p)].map(text => element("td", text, { class: "text" })).concat([p.nan, p.positiveInf, p.negativeInf].map(n =>
      element("td", String(n), { class: n ? "bad" : "" })))))));
  const alignment = report.alignment;
  if (alignment && (alignment.dx || alignment.dy))
    byId("notes").append(element("li", `B shifted by x ${alignment.dx}, y ${alignment.dy} pixels fits better: RMSE ${number(alignment.rmse)} instead of ${number(alignment.rmseInPlace)}`));
  byId("scale-note").textContent = (data.step > 1 ? `The pictures here are ${data.step} times smaller each way: colors are means of ${data.step} × ${data.step} pixels, maps show the largest error of them. All figures are of the whole pictures. ` : "") +
    "Colors here are half floats; magenta is what is not finite.";
}

// ---- input

function connectControls() {
  const views = byId("views");
  for (const [value, text] of kViews) {
    const option = element("label"), input = element("input", undefined, { type: "radio", name: "view", value });
    input.onchange = () => show(value);
    option.append(input, " " + text);
    views.append(option);
  }
  layers.forEach((layer, i) => byId("layer").append(element("option", layer.name, { value: i })));
  byId("layer").onchange = event => choose(Number(event.target.value));
  byId("exposure").oninput = event => expose(Number(event.target.value));
  byId("fit").onclick = fit;
  byId("actual").onclick = () => { state.zoom = 1 / (window.devicePixelRatio || 1); place(data.width / 2, data.height / 2); };
}
// Of the pointer in the canvas.
function position(event) {
  const box = canvas.getBoundingClientRect();
  return [event.clientX - box.left - canvas.clientLeft, event.clientY - box.top - canvas.clientTop];
}
function connectDragging() {
  let held = null;
  canvas.onpointerdown = event => {
    const [x, y] = position(event), isDivider = state.view === "split" && Math.abs(x - state.divider * canvas.clientWidth) < 12;
    held = { isDivider, x, y };
    canvas.setPointerCapture(event.pointerId);
  };
  canvas.onpointermove = event => {
    const [x, y] = position(event);
    const inPane = state.view === "side" && x > paneWidth() ? x - paneWidth() : x;
    if (!held) return readout(Math.floor((inPane - state.x) / state.zoom), Math.floor((y - state.y) / state.zoom));
    if (held.isDivider) state.divider = Math.min(Math.max(x / canvas.clientWidth, 0), 1);
    else { state.x += x - held.x; state.y += y - held.y; }
    held = { isDivider: held.isDivider, x, y };
    draw();
  };
  canvas.onpointerup = canvas.onpointercancel = () => { held = null; };
}
function connectZooming() {
  canvas.addEventListener("wheel", event => {
    event.preventDefault();
    const [x, y] = position(event);
    zoomAt(state.view === "side" && x > paneWidth() ? x - paneWidth() : x, y, state.zoom * 2 ** (-event.deltaY / 300));
  }, { passive: false });
}
function connectKeys() {
  canvas.onkeydown = event => {
    const steps = { ArrowLeft: [40, 0], ArrowRight: [-40, 0], ArrowUp: [0, 40], ArrowDown: [0, -40] }[event.key];
    if (steps) { state.x += steps[0]; state.y += steps[1]; draw(); }
    else if (event.key === "+" || event.key === "-") zoomAt(paneWidth() / 2, canvas.clientHeight / 2, state.zoom * (event.key === "+" ? 2 : 0.5));
    else return;
    event.preventDefault();
  };
}
function startBlinking() {
  let changed = 0;
  setInterval(() => {
    const now = performance.now();
    if (state.view !== "blink" || now - changed < 1000 * Math.max(Number(byId("blink").value) || 0.5, 0.1)) return;
    changed = now;
    state.isB = !state.isB;
    draw();
  }, 50);
}
function connect() {
  for (const part of [connectControls, connectDragging, connectZooming, connectKeys, startBlinking]) part();
  new ResizeObserver(draw).observe(canvas);
}
// "#view=flip&layer=albedo&stops=2&x=10&y=20" in the address: what to show at first.
function applyAddress() {
  const wanted = new URLSearchParams(location.hash.slice(1));
  const index = layers.findIndex(layer => layer.name === wanted.get("layer"));
  if (index > 0) choose(index);
  if (wanted.has("stops")) expose(Number(wanted.get("stops")));
  if (kViews.some(([view]) => view === wanted.get("view"))) show(wanted.get("view"));
  if (wanted.has("x") && wanted.has("y")) jump(layers[state.layer].name, Number(wanted.get("x")), Number(wanted.get("y")));
}

async function main() {
  drawTexts();
  drawFigures();
  drawChecks();
  drawWorst();
  const read = (plane, reader) => plane ? reader(plane, data.width, data.height) : null;
  layers = await Promise.all(data.layers.map(async layer => ({
    name: layer.name, flipHistogram: layer.flipHistogram,
    a: layer.a && await Promise.all(layer.a.map(plane => read(plane, readHalves))),
    b: layer.b && await Promise.all(layer.b.map(plane => read(plane, readHalves))),
    flip: await read(layer.flip, readBytes), heat: await read(layer.heat, readBytes) })));
  if (layers.length) {
    connect();
    choose(0);
    fit();
    applyAddress();
  } else byId("canvas").parentElement.hidden = true;
  document.documentElement.dataset.ready = "true";
}
main().catch(error => {
  byId("problem").hidden = false;
  byId("problem").textContent = `The pictures cannot be shown: ${error}`;
});
