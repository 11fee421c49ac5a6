// Line charts and the drawing of the train, as SVG: curves that go anywhere, words that do not touch, and the same
// picture on paper. plot.js lets people look into them.

/** Width of a letter of a chart, on average and generously. [px] */
const LETTER = 6.2;
const SVG = "http://www.w3.org/2000/svg";
/** Dark enough to print, and told apart by the colour-blind (Okabe and Ito). */
export const COLOURS = ["#1f4e79", "#c0504d", "#2e7d5b", "#8a6d1d", "#6a4c93", "#4a4a4a"];

export function element(name, attributes = {}, text = null) {
  const made = document.createElementNS(SVG, name);
  for (const [key, value] of Object.entries(attributes)) made.setAttribute(key, value);
  if (text !== null) made.textContent = text;
  return made;
}

/** Round numbers that divide an interval into about `count` parts. */
export function ticks(least, largest, count) {
  const rough = (largest - least) / Math.max(1, count);
  // an interval that its own numbers can hardly tell apart has no round numbers in it
  if (!(rough > 1e-12 * Math.max(Math.abs(least), Math.abs(largest))) || !Number.isFinite(rough)) {
    return Number.isFinite(least) ? [least] : [];
  }
  const power = 10 ** Math.floor(Math.log10(rough));
  const step = [1, 2, 2.5, 5, 10].map(m => m * power).find(s => s >= rough * 0.999);
  const places = [];
  for (let k = Math.ceil(least / step - 1e-9); k * step <= largest + 1e-9 * step; k += 1) {
    places.push(Math.abs(k * step) < 1e-12 * step ? 0 : k * step);
  }
  return places;
}

/** A number for an axis: no power of ten below a million, no rounding noise. */
export function short(value) {
  if (value === 0) return "0";
  const size = Math.abs(value);
  if (size >= 1e7 || size < 1e-4) return value.toExponential(1);
  return Number(value.toPrecision(6)).toLocaleString("en-US", { maximumFractionDigits: 8 });
}

function extent(lists, padded) {
  const all = lists.flat().filter(v => typeof v === "number");
  if (!all.length) return [0, 1];
  let least = all.reduce((a, b) => Math.min(a, b)), largest = all.reduce((a, b) => Math.max(a, b));
  if (least === largest) { least -= 1; largest += 1; }
  const pad = padded ? 0.06 * (largest - least) : 0;
  return [least >= 0 && least - pad < 0 ? 0 : least - pad, largest + pad];
}

/** Points as a path, those outside x0 to x1 left out but for the next; a blank is a gap. */
function path(xs, ys, toX, toY, [x0, x1]) {
  let open = false, drawn = "";
  const isIn = i => typeof xs[i] === "number" && typeof ys[i] === "number";
  const isNear = i => Math.max(xs[i], isIn(i - 1) ? xs[i - 1] : xs[i], isIn(i + 1) ? xs[i + 1] : xs[i]) >= x0
    && Math.min(xs[i], isIn(i - 1) ? xs[i - 1] : xs[i], isIn(i + 1) ? xs[i + 1] : xs[i]) <= x1;
  for (let i = 0; i < Math.max(xs.length, ys.length); i += 1) {
    if (!isIn(i) || !isNear(i)) { open = false; continue; }
    drawn += `${open ? "L" : "M"}${toX(xs[i]).toFixed(1)} ${toY(ys[i]).toFixed(1)}`;
    open = true;
  }
  return drawn;
}

/** Range of values of series where x is between two numbers; values at the ends are interpolated. */
function heightsIn(series, [x0, x1]) {
  const heights = [];
  for (const { x, y } of series) {
    for (let i = 0; i < x.length; i += 1) {
      if (typeof x[i] !== "number" || typeof y[i] !== "number") continue;
      if (x[i] >= x0 && x[i] <= x1) heights.push(y[i]);
      if (i === 0 || typeof x[i - 1] !== "number" || typeof y[i - 1] !== "number" || x[i] === x[i - 1]) continue;
      for (const end of [x0, x1]) {
        const share = (end - x[i - 1]) / (x[i] - x[i - 1]);
        if (share > 0 && share < 1) heights.push(y[i - 1] + share * (y[i] - y[i - 1]));
      }
    }
  }
  return heights;
}

/** A level that would make the curves flat is not drawn but named: how many times their height it may be away. */
const FAR = 1.5;

/** Range of the values that are shown: of curves where they are seen, and of levels not too far off. */
function heightsShown(what, rangeX) {
  const curves = heightsIn(what.series, rangeX);
  const [least, largest] = extent([curves], false);
  const reach = FAR * (largest - least);
  const near = (what.levels || []).map(level => level.y).filter(y => y <= largest + reach && y >= least - reach);
  return extent([[...curves, ...near]], true);
}

/**
 * One chart.
 * what.series: {name, x, y, colour, ink, dash, width}; what.marks: {x, y, text, anchor} words at a point;
 * what.points: {x, y, text} with a dot; what.verticals: {x, text} lines across with a word on top; what.levels: {y};
 * what.x and what.y: axis titles; what.rangeX: what is seen of it; what.width: the width it
 * will be shown at, so that its letters are as large as those around it. [px]
 * The picture has its `frame`: where the axes are and what they show.
 */
export function chart(what) {
  const width = what.width || 640, height = Math.round((what.height || 300) * (width < 480 ? 0.85 : 1));
  const entries = legendOf(what, width);
  const legend = entries.length ? 20 + 16 * entries[entries.length - 1].row : 0;
  const left = 66, right = what.right || 16, top = 10 + legend, bottom = 40;
  const rangeX = what.rangeX || extent(what.series.map(s => s.x), false), [x0, x1] = rangeX;
  const [y0, y1] = what.rangeY || heightsShown(what, rangeX);
  const toX = v => left + ((v - x0) / (x1 - x0)) * (width - left - right);
  const toY = v => height - bottom - ((v - y0) / (y1 - y0)) * (height - top - bottom);
  const isSeen = x => x >= x0 && x <= x1;
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": what.title, class: "chart" });
  svg.frame = { x0, x1, y0, y1, left, right: width - right, top, bottom: height - bottom, width };
  for (const v of ticks(x0, x1, Math.max(3, Math.min(8, Math.floor((width - left - right) / 58))))) {
    svg.append(element("line", { x1: toX(v), x2: toX(v), y1: top, y2: height - bottom, class: "grid" }));
    svg.append(element("text", { x: toX(v), y: height - bottom + 15, class: "tick middle" }, short(v)));
  }
  for (const v of ticks(y0, y1, 6)) {
    svg.append(element("line", { x1: left, x2: width - right, y1: toY(v), y2: toY(v), class: v === 0 ? "zero" : "grid" }));
    svg.append(element("text", { x: left - 6, y: toY(v) + 4, class: "tick end" }, short(v)));
  }
  // a picture in the picture cuts off what is outside of the axes
  const inside = { x: left, y: top, width: width - left - right, height: height - top - bottom };
  const curves = element("svg", { ...inside, viewBox: `${inside.x} ${inside.y} ${inside.width} ${inside.height}`, preserveAspectRatio: "none" });
  for (const { x } of (what.verticals || []).filter(one => isSeen(one.x))) {
    curves.append(element("line", { x1: toX(x), x2: toX(x), y1: top, y2: height - bottom, class: "passing" }));
  }
  for (const s of what.series) {
    const drawn = path(s.x, s.y, toX, toY, rangeX);
    if (drawn) curves.append(element("path", { d: drawn, class: `line ink-${s.ink}`, stroke: s.colour, "stroke-dasharray": s.dash || "none", "stroke-width": s.width || 1.2 }));
  }
  for (const { y } of what.levels || []) {
    curves.append(element("line", { x1: left, x2: width - right, y1: toY(y), y2: toY(y), class: "level" }));
  }
  svg.append(curves);
  svg.append(element("rect", { x: left, y: top, width: inside.width, height: inside.height, class: "frame" }));
  for (const p of (what.points || []).filter(one => isSeen(one.x))) {
    svg.append(element("circle", { cx: toX(p.x), cy: toY(p.y), r: 3.2, class: "dot" }));
    if (!p.text) continue;
    // right of the dot and below it, or left of it and above, where the frame would cut it
    const fits = toX(p.x) + 7 + LETTER * p.text.length < width - right;
    svg.append(element("text", { x: toX(p.x) + (fits ? 7 : -7), y: Math.max(toY(p.y) + (fits ? 12 : -5), top + 11), class: fits ? "mark" : "mark end" }, p.text));
  }
  const taken = [], onTop = (what.verticals || []).map(({ x, text }) => ({ x, y: y1, text, anchor: "middle" }));
  for (const m of [...onTop, ...(what.marks || [])].filter(one => isSeen(one.x))) {
    let x = toX(m.x) + (m.dx || 0), y = toY(m.y) + (m.dy || 0);
    if (m.anchor === "middle") { // inside the frame
      const half = LETTER * m.text.length / 2 + 2;
      x = Math.max(left + half, Math.min(width - right - half, x));
      y = Math.max(top + 11, y);
      while (taken.some(t => Math.abs(t.y - y) < 11 && Math.abs(t.x - x) < t.half + half)) y += 12;
      taken.push({ x, y, half });
    }
    svg.append(element("text", { x, y, class: `mark ${m.anchor || ""}` }, m.text));
  }
  svg.append(element("text", { x: (left + width - right) / 2, y: height - 6, class: "axis middle" }, what.x));
  svg.append(element("text", { transform: `translate(13 ${(top + height - bottom) / 2}) rotate(-90)`, class: "axis middle" }, what.y));
  for (const { name, colour, ink, dash, dot, at, row } of entries) {
    const y = 12 + 16 * row;
    svg.append(dot ? element("circle", { cx: at + 9, cy: y, r: 3.2, class: "dot" })
      : element("line", { x1: at, x2: at + 18, y1: y, y2: y, stroke: colour, class: `ink-${ink}`, "stroke-width": 2, "stroke-dasharray": dash || "none" }));
    svg.append(element("text", { x: at + 23, y: y + 4, class: "mark" }, name));
  }
  return svg;
}

/**
 * What `chart` draws of one record of addin/contract/charts.py and the columns of its tables; null
 * where it has no curve. extras: options of `chart`, and `values`, which words a value beside a point.
 */
export function fromRecord(record, tables, extras = {}) {
  const series = [], points = [...(extras.points || [])], marks = [];
  for (const curve of record.series) {
    const x = tables[curve.table][curve.x], y = tables[curve.table][curve.y];
    if (curve.row !== null) {
      if (typeof x[curve.row] !== "number" || !curve.name) continue;
      const at = { x: x[curve.row], y: y[curve.row], text: curve.name };
      if (curve.marked) points.push(at);
      else marks.push({ ...at, anchor: "middle", dy: -3 });
    } else if (curve.values) {
      y.forEach((value, i) => marks.push({ x: x[i], y: value, ...extras.values(value, i) }));
    } else if (x.length && y.length) {
      series.push({ name: record.legend && curve.listed ? curve.name : "", label: curve.name, x, y, colour: curve.colour, ink: curve.ink, width: 0.9 * curve.width, dash: curve.dashed ? "6 3" : "none" });
    }
  }
  if (!series.length) return null;
  return { height: 300, ...extras, title: record.title, x: record.x, y: record.y, legend: record.legend, series, points, marks };
}

/** Entries of the legend and their places, row by row. */
function legendOf(what, width) {
  const named = what.series.filter(s => s.name);
  if (named.length < 2 && !what.legend) return [];
  if (what.pointsName && (what.points || []).length) named.push({ name: what.pointsName, dot: true });
  let at = 66, row = 0;
  return named.map(entry => {
    const needed = 30 + LETTER * entry.name.length;
    if (at > 66 && at + needed > width) { at = 66; row += 1; }
    const placed = { ...entry, at, row };
    at += needed + 10;
    return placed;
  });
}

/** The schematic: shapes as the server lays them out, those behind first; null where there is none. */
export function schematic(picture) {
  if (!picture) return null;
  const svg = element("svg", { viewBox: `0 0 ${picture.width} ${picture.height}`, role: "img", "aria-label": "Schematic of the train, not to scale", class: "schematic" });
  const inPixels = points => points * 96 / 72;
  for (const shape of picture.shapes) {
    const { left, top, width, height } = shape;
    const corners = shape.points.length ? shape.points : [[0, 0], [width, 0], [width, height], [0, height]];
    if (shape.fill || shape.line) {
      svg.append(element("polygon", {
        points: corners.map(([x, y]) => `${(left + x).toFixed(1)},${(top + y).toFixed(1)}`).join(" "),
        fill: shape.fill || "none", stroke: shape.line || "none", "stroke-width": inPixels(shape.thickness),
      }));
    }
    if (!shape.text) continue;
    const lines = shape.text.split("\n"), step = inPixels(shape.size) * 1.15;
    const [share, anchor] = { ctr: [0.5, "middle"], l: [0, "start"], r: [1, "end"] }[shape.side];
    const words = element("text", { fill: shape.ink, "text-anchor": anchor, "font-size": inPixels(shape.size), "font-weight": shape.bold ? "bold" : "normal" });
    lines.forEach((line, k) => words.append(element("tspan", {
      x: left + share * width, y: top + height / 2 + (k - (lines.length - 1) / 2) * step, "dominant-baseline": "central",
    }, line)));
    svg.append(words);
  }
  return svg;
}

/** Words broken into lines of about so many letters. */
function broken(text, letters) {
  const lines = [""];
  for (const word of String(text).split(/\s+/)) {
    const last = lines[lines.length - 1];
    if (last && last.length + word.length + 1 > letters) lines.push(word);
    else lines[lines.length - 1] = last ? `${last} ${word}` : word;
  }
  return lines.slice(0, 3);
}

/**
 * The train: discs (half height ~ fourth root of inertia), shafts (~ fourth root of stiffness) and
 * meshes, in the order of the tables. items: {name, kind: disc | shaft | mesh | gap, height, group}.
 */
export function train(items, groups) {
  const widths = { disc: 26, shaft: 62, mesh: 14, gap: 30 };
  const total = items.reduce((sum, item) => sum + widths[item.kind], 0) + 40;
  const tall = 62, middle = 24 + tall, height = middle + tall + 56;
  const width = Math.max(total, 420);
  const svg = element("svg", { viewBox: `0 0 ${width} ${height}`, role: "img", "aria-label": "The train: discs and shafts", class: "train" });
  let at = (width - total) / 2 + 20, discs = 0;
  for (const item of items) {
    const w = widths[item.kind], h = Math.max(2, tall * item.height);
    if (item.kind === "gap") {
      svg.append(element("line", { x1: at + w / 2, x2: at + w / 2, y1: middle - tall, y2: middle + tall, class: "gap" }));
    } else if (item.kind === "mesh") {
      svg.append(element("rect", { x: at, y: middle - h, width: w, height: 2 * h, class: "mesh" }));
    } else {
      const body = element("rect", { x: at, y: middle - h, width: w, height: 2 * h, fill: COLOURS[item.group % COLOURS.length], class: `${item.kind} group-${item.group}` });
      body.append(element("title", {}, item.name));
      svg.append(body);
    }
    if (item.kind === "disc" && item.name) {
      // every second name stands above, so that neighbours do not run into each other
      const above = discs % 2 === 1, lines = broken(item.name, 15);
      const y = above ? middle - tall - 8 - 11 * (lines.length - 1) : middle + tall + 16;
      svg.append(element("line", { x1: at + w / 2, x2: at + w / 2, y1: above ? middle - tall - 4 : middle + tall + 5, y2: above ? middle - h : middle + h, class: "leader" }));
      lines.forEach((line, k) => svg.append(element("text", { x: at + w / 2, y: y + 11 * k, class: "mark middle" }, line)));
      discs += 1;
    }
    at += w;
  }
  let across = 20;
  groups.forEach((name, k) => {
    svg.append(element("rect", { x: across, y: height - 11, width: 9, height: 9, fill: COLOURS[k], class: `group-${k}` }));
    svg.append(element("text", { x: across + 14, y: height - 3, class: "mark" }, name));
    across += 34 + 6.4 * name.length;
  });
  return svg;
}
