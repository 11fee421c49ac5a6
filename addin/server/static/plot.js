// A chart to look into: zoom, cursor and reading, by mouse, fingers and keys. Charts of one group show the same
// part of their axes and have one cursor.
import { chart, element, short } from "./charts.js";

/** Share of what is seen that a key moves the cursor by, and that a key or a button zooms to. [1] */
const STEP = 0.01, ZOOM = 0.5;
/** Smallest part of the whole that is shown, and shortest drag that is a choice and not a click. [1, px] */
const CLOSEST = 1e-5, DRAG = 6;
/** Curves that a reading names, and values of each. [count] */
const READ = 8;
/** The sentence that explains it, once for all charts of a page. */
const HELP = "Drag across a chart to zoom, double-click to see all. Keys: arrows move the cursor, with Shift the picture; + and − zoom, 0 shows all.";
const HELP_ID = "chart-help";

/** Charts with one axis: what they show of it, where the cursor is, and who wants to know. */
export class Group {
  constructor() {
    this.plots = [];
    this.range = null;
    this.cursor = null;
    this.changed = () => {};
  }

  /** Whole range of the axis. */
  get whole() {
    const ends = this.plots.map(plot => plot.whole);
    return [Math.min(...ends.map(end => end[0])), Math.max(...ends.map(end => end[1]))];
  }

  get shown() { return this.range || this.whole; }

  show(begin, end) {
    const [least, largest] = this.whole, size = Math.min(Math.max(end - begin, CLOSEST * (largest - least)), largest - least);
    const from = Math.min(Math.max(begin, least), largest - size);
    this.range = size >= (largest - least) * (1 - 1e-9) ? null : [from, from + size];
    for (const plot of this.plots) plot.draw();
    this.changed(this.range);
  }

  /** Zoom by a factor about a place. */
  zoom(factor, about = null) {
    const [begin, end] = this.shown, middle = about ?? (begin + end) / 2;
    this.show(middle - (middle - begin) * factor, middle + (end - middle) * factor);
  }

  move(share) {
    const [begin, end] = this.shown, by = share * (end - begin);
    this.show(begin + by, end + by);
  }

  point(x, from = null) {
    this.cursor = x;
    for (const plot of this.plots) plot.point(plot === from);
  }

  clear() {
    this.plots = [];
    this.range = this.cursor = null;
  }
}

/** Values of a curve at x, between its points; a curve of several lines has several, the least first. */
export function valuesAt({ x, y }, at) {
  const values = [];
  for (let i = 1; i < x.length; i += 1) {
    const [a, b, c, d] = [x[i - 1], x[i], y[i - 1], y[i]];
    if (![a, b, c, d].every(v => typeof v === "number")) continue;
    if (Math.min(a, b) <= at && at <= Math.max(a, b) && a !== b) values.push(c + (d - c) * (at - a) / (b - a));
  }
  return [...new Set(values)].sort((a, b) => a - b);
}

function button(text, label, act) {
  const made = document.createElement("button");
  made.type = "button";
  made.textContent = text;
  made.setAttribute("aria-label", label);
  made.title = label;
  made.addEventListener("click", act);
  return made;
}

/** One interactive chart. what: as for `chart`; width: a function, as the room may change. */
export class Plot {
  constructor(what, width, group = new Group()) {
    this.group = group;
    this.width = width;
    this.node = document.createElement("figure");
    this.node.className = "plot";
    this.head = document.createElement("figcaption");
    this.tools = document.createElement("span");
    this.tools.className = "tools noprint";
    const name = what.title;
    this.tools.append(
      button("+", `Zoom in: ${name}`, () => group.zoom(ZOOM, group.cursor)),
      button("−", `Zoom out: ${name}`, () => group.zoom(1 / ZOOM, group.cursor)),
      button("All", `Show all: ${name}`, () => group.show(...group.whole)),
    );
    this.caption = document.createElement("b");
    this.head.append(this.caption, this.tools);
    this.room = document.createElement("div");
    this.room.className = "picture";
    this.room.tabIndex = 0;
    this.room.setAttribute("role", "group");
    this.room.setAttribute("aria-roledescription", "chart");
    this.room.setAttribute("aria-describedby", HELP_ID);
    this.reading = document.createElement("output");
    this.reading.className = "reading noprint";
    this.node.append(this.head, this.room, this.reading);
    this.listen();
    group.plots.push(this);
    this.set(what);
  }

  /** Show something else, or more of the same. */
  set(what) {
    this.what = what;
    this.whole = what.whole || what.rangeX || wholeOf(what.series);
    this.caption.textContent = what.title;
    this.room.setAttribute("aria-label", what.title);
    this.draw();
  }

  draw(width = this.width()) {
    const [begin, end] = this.group.range || this.whole;
    this.svg = chart({ ...this.what, width, rangeX: [begin, end] });
    this.room.replaceChildren(this.svg);
    this.svg.append(this.band = element("rect", { class: "band", visibility: "hidden" }));
    this.svg.append(this.line = element("line", { class: "cursor noprint", visibility: "hidden" }));
    this.svg.append(this.dots = element("g", { class: "noprint" }));
    this.point(false);
  }

  /** x of the axis from a place on the screen. */
  at(clientX) {
    const { left, right, x0, x1, width } = this.svg.frame, box = this.svg.getBoundingClientRect();
    const place = (clientX - box.left) * width / box.width;
    return x0 + (x1 - x0) * Math.min(1, Math.max(0, (place - left) / (right - left)));
  }

  /** x of the axis → place in the picture. */
  place(x) {
    const { left, right, x0, x1 } = this.svg.frame;
    return left + (right - left) * (x - x0) / (x1 - x0);
  }

  /** Draw the cursor, and say what the curves have there. */
  point(isHere) {
    const x = this.group.cursor, { x0, x1, top, bottom, y0, y1 } = this.svg.frame;
    const isSeen = x !== null && x >= x0 && x <= x1;
    this.line.setAttribute("visibility", isSeen ? "visible" : "hidden");
    this.dots.replaceChildren();
    this.reading.setAttribute("aria-live", isHere ? "polite" : "off");
    if (!isSeen) { this.reading.textContent = ""; return; }
    for (const end of ["x1", "x2"]) this.line.setAttribute(end, this.place(x));
    this.line.setAttribute("y1", top);
    this.line.setAttribute("y2", bottom);
    const [, word, unit] = /^(.*?)(?: \[(.*)\])?$/.exec(this.what.x), parts = [`${word} ${short(rounded(x, x1 - x0))}${unit ? ` ${unit}` : ""}`];
    for (const series of this.what.series.filter(one => one.label || one.name || this.what.series.length === 1).slice(0, READ)) {
      const values = valuesAt(series, x).filter(value => value >= y0 && value <= y1);
      if (!values.length) continue;
      const name = this.what.series.length > 1 ? series.label || series.name : "";
      const few = values.slice(0, READ).map(value => short(rounded(value, y1 - y0))).join(", ");
      parts.push(`${name}${name ? " " : ""}${few}${values.length > READ ? ", …" : ""}`);
      for (const value of values) this.dots.append(element("circle", { cx: this.place(x), cy: bottom - (bottom - top) * (value - y0) / (y1 - y0), r: 3, class: `spot ink-${series.ink}` }));
    }
    const of = /\[(.*)\]$/.exec(this.what.y);
    this.reading.textContent = parts.join(" · ") + (of && parts.length > 1 ? ` ${of[1]}` : "");
  }

  listen() {
    let began = null;
    const over = event => { const { left, right } = event.currentTarget.getBoundingClientRect(); return event.clientX >= left && event.clientX <= right; };
    this.room.addEventListener("pointerdown", event => {
      if (event.button !== 0) return;
      if (event.pointerType !== "touch") { began = event.clientX; this.room.setPointerCapture(event.pointerId); }
      this.group.point(this.at(event.clientX), this);
    });
    this.room.addEventListener("pointermove", event => {
      if (!over(event)) return;
      this.group.point(this.at(event.clientX), null);
      if (began === null || Math.abs(event.clientX - began) < DRAG) return;
      const ends = [this.place(this.at(began)), this.place(this.at(event.clientX))].sort((a, b) => a - b), { top, bottom } = this.svg.frame;
      for (const [key, value] of Object.entries({ x: ends[0], width: ends[1] - ends[0], y: top, height: bottom - top, visibility: "visible" })) this.band.setAttribute(key, value);
    });
    this.room.addEventListener("pointerup", event => {
      if (began === null) return;
      const from = began;
      began = null;
      if (Math.abs(event.clientX - from) >= DRAG) this.group.show(...[this.at(from), this.at(event.clientX)].sort((a, b) => a - b));
    });
    this.room.addEventListener("pointercancel", () => { began = null; this.draw(); });
    this.room.addEventListener("pointerleave", () => { if (began === null && document.activeElement !== this.room) this.group.point(null); });
    this.room.addEventListener("dblclick", () => this.group.show(...this.group.whole));
    this.room.addEventListener("wheel", event => { // without Ctrl the page scrolls
      if (!event.ctrlKey) return;
      event.preventDefault();
      this.group.zoom(event.deltaY < 0 ? 0.8 : 1.25, this.at(event.clientX));
    }, { passive: false });
    this.room.addEventListener("keydown", event => this.key(event));
    this.room.addEventListener("blur", () => this.group.point(null));
  }

  key(event) {
    if (event.ctrlKey || event.metaKey || event.altKey) return;
    const { group } = this, [begin, end] = group.shown, cursor = group.cursor ?? (begin + end) / 2;
    const step = { ArrowLeft: -1, ArrowRight: 1 }[event.key];
    if (step && event.shiftKey) group.move(10 * STEP * step);
    else if (step) {
      const to = cursor + step * STEP * (end - begin);
      if (to < begin || to > end) group.move(10 * STEP * step);
      group.point(Math.min(Math.max(to, group.whole[0]), group.whole[1]), this);
    } else if (event.key === "+" || event.key === "=") group.zoom(ZOOM, cursor);
    else if (event.key === "-" || event.key === "−") group.zoom(1 / ZOOM, cursor);
    else if (event.key === "0" || event.key === "Escape") group.show(...group.whole);
    else return;
    event.preventDefault();
  }
}

function wholeOf(series) {
  let least = Infinity, largest = -Infinity;
  for (const { x } of series) for (const v of x) if (typeof v === "number") { if (v < least) least = v; if (v > largest) largest = v; }
  return least < largest ? [least, largest] : [least - 1, least + 1];
}

/** A number to a ten-thousandth of what is seen: more digits mean nothing in a picture. */
function rounded(value, size) {
  const power = 10 ** Math.floor(Math.log10(Math.max(size, 1e-300)) - 3);
  return Math.round(value / power) * power;
}

export function help() {
  const node = document.createElement("p");
  node.id = HELP_ID;
  node.className = "hint noprint";
  node.textContent = HELP;
  return node;
}
