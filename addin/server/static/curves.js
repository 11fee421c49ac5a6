// The charts of the page: those of the workbook's records, and the histories of the elements that are chosen.
import { fromRecord } from "./charts.js";
import { at, made, number, stream } from "./page.js";
import { Group, Plot, help } from "./plot.js";

/** Widths of charts on paper: across the page and half of it. [px] */
const PAPER = { whole: 660, half: 345 };
/** Histories at first, and at most. [count] */
const FEW = 6, MOST = 24;
/** How long a window of time stands still before its histories are asked for. [ms] */
const STILL = 150;

/** Charts against time have one axis and one cursor. */
const time = new Group();
let plots = [], onPaper = false, histories = null;

/** Elements whose histories are drawn, by the model's names; empty = the first. */
export const chosen = { names: [], changed: () => {} };

const isInHalf = () => matchMedia("(min-width: 48rem)").matches;

/** The width at which a chart is shown. */
function room(id, isHalf) {
  if (onPaper) return PAPER[id === "interference" ? "whole" : "half"];
  const parts = isHalf && isInHalf() ? 2 : 1;
  return Math.round(Math.max(236, Math.min(900, at(id).clientWidth / parts - (parts > 1 ? 16 : 0))));
}

function put(id, what, { group, isHalf = false } = {}) {
  const plot = new Plot(what, () => room(id, isHalf), group);
  plots.push(plot);
  at(id).append(plot.node);
  plot.draw(); // at the width it has now
  return plot;
}

/** All charts of a view. */
export function showCurves(view, model) {
  const { charts, drawn, complete } = view, wait = complete ? "None." : "Not calculated yet.";
  for (const id of ["interference", "torque", "speed", "histories", "event-curves"]) at(id).replaceChildren();
  const seen = time.range;
  time.clear();
  time.range = complete ? seen : null;
  plots = [];
  if (!document.getElementById("chart-help")) at("results").append(help());
  for (const record of drawn) {
    const { id, missing, extras, group, isHalf } = placeOf(record.name, charts, wait);
    const what = fromRecord(record, charts, extras);
    if (what) put(id, what, { group, isHalf });
    else if (missing) at(id).append(made("p", missing, "missing"));
  }
  histories = null;
  at("choice").hidden = !complete || !view.histories.length;
  if (!complete || !view.histories.length) {
    at("histories").append(made("p", wait, "missing"));
    return;
  }
  histories = new Histories(view, model);
  histories.choose(chosen.names);
}

/** Charts are drawn anew for another width, or for paper. */
export function redraw(forPaper = false) {
  onPaper = forPaper;
  for (const plot of plots) plot.draw();
}

// --- histories ------------------------------------------------------------------------------------

class Histories {
  constructor(view, model) {
    this.model = model;
    this.names = view.histories;
    this.passings = passingsOf(view);
    this.plots = new Map();
    this.running = null;
    time.changed = () => { clearTimeout(this.timer); this.timer = setTimeout(() => this.load(), STILL); };
    this.boxes = this.names.map(name => {
      const label = made("label"), box = made("input");
      box.type = "checkbox";
      box.value = name;
      box.addEventListener("change", () => this.take());
      label.append(box, name);
      return { label, box };
    });
    at("choice-list").replaceChildren(...this.boxes.map(one => one.label));
  }

  /** Draw some of the elements; the first ones where none is chosen. */
  choose(names) {
    const there = names.filter(name => this.names.includes(name));
    this.chosen = there.length ? there : this.names.slice(0, FEW);
    for (const { box } of this.boxes) box.checked = this.chosen.includes(box.value);
    this.load();
  }

  take() {
    const names = this.boxes.filter(one => one.box.checked).map(one => one.box.value).slice(0, MOST);
    chosen.names = names;
    chosen.changed();
    this.choose(names);
  }

  /** Ask for what is seen; the last window asked for is drawn. */
  async load() {
    if (this.running) this.running.cancel();
    const range = time.range, window = range ? { from: range[0], to: range[1] } : {};
    const run = stream({ histories: this.model, elements: this.chosen, ...window });
    this.running = run;
    let shown;
    try { shown = await run.done; } catch (failed) {
      if (!failed.cancelled && histories === this) at("histories").replaceChildren(made("p", failed.message, "missing"));
      return;
    }
    if (histories === this && this.running === run) this.show(shown, !range);
  }

  show(shown, isWhole) {
    for (const [name, plot] of this.plots) {
      if (this.chosen.includes(name)) continue;
      plot.node.remove();
      plots.splice(plots.indexOf(plot), 1);
      time.plots.splice(time.plots.indexOf(plot), 1);
      this.plots.delete(name);
    }
    if (!this.plots.size) at("histories").replaceChildren();
    for (const one of shown) {
      const plot = this.plots.get(one.element), what = this.drawn(one, isWhole ? null : plot && plot.whole);
      if (plot) plot.set(what);
      else this.plots.set(one.element, put("histories", what, { group: time, isHalf: true }));
    }
    shown.forEach((one, i) => { // what is in its place stays there: moved, it would lose the focus
      const { node } = this.plots.get(one.element), there = at("histories").children[i] || null;
      if (there !== node) at("histories").insertBefore(node, there);
    });
  }

  drawn({ title, axis, time: x, value: y, limit }, whole) {
    const levels = limit ? [...new Set([limit.upper, limit.lower])].map(level => ({ y: level })) : [];
    const unit = (/\[(.*)\]/.exec(axis) || [])[1] || "";
    const words = limit ? `; limit ${limit.lower === -limit.upper ? "± " : `${number(limit.lower)} to `}${number(limit.upper)} ${unit} (${limit.words})` : "";
    return {
      title: title + words, x: "Time [s]", y: axis, height: 250, legend: false, whole, levels,
      series: [{ name: "", label: "", x, y, colour: "#1F3A5F", ink: "navy", width: 0.9, dash: "none" }],
      verticals: this.passings,
    };
  }
}

/** When the pulsation passes a mode, and when something happens: as named in the chart of the speed. */
function passingsOf({ drawn, charts }) {
  const record = drawn.find(one => one.name === "speed-time");
  if (!record) return [];
  return record.series.filter(curve => curve.row !== null && curve.name).map(curve => ({
    x: charts[curve.table][curve.x][curve.row], text: curve.name.replace(/:[^;]*?Hz/g, ""),
  })).filter(one => typeof one.x === "number");
}

// --- the other charts -----------------------------------------------------------------------------

/** Where a curve passes a level: points for a chart. */
function crossings(xs, ys, level) {
  const points = [];
  for (let i = 1; i < xs.length; i += 1) {
    const [a, b] = [ys[i - 1] - level, ys[i] - level];
    if (a * b < 0) points.push({ x: xs[i - 1] + (xs[i] - xs[i - 1]) * a / (a - b), y: level, text: "" });
  }
  return points;
}

/** How far each of some rising labels is moved up, so that neighbours can be read. */
function apart(values, top) {
  const near = 0.045 * top, step = 10;
  const moved = [];
  values.forEach((value, i) => {
    const close = i > 0 && value - values[i - 1] < near;
    moved.push(close ? moved[i - 1] + step * (1 - (value - values[i - 1]) / near) : 0);
  });
  return moved;
}

/** What the interference diagram shows besides its record: where 2 × slip meets the modes, words that do not touch. */
function interferenceExtras(data) {
  const top = Math.max(...data.Modes.filter(v => v !== null), ...data.Range.filter(v => v !== null), ...data["2 x slip"]);
  const moved = apart(data.Label, top);
  return {
    height: 380, right: 62, rangeY: [0, top * 1.03], pointsName: "2 × slip crosses a mode",
    points: data.Label.flatMap(level => crossings(data["Slip speed"], data["2 x slip"], level)),
    values: (value, i) => ({ text: `${number(value)} Hz`, dx: 5, dy: 4 - moved[i] }),
  };
}

/** Where each chart stands on the page, how high it is, and what is said where it has no curve. */
function placeOf(name, charts, wait) {
  if (name === "interference") {
    const extras = charts.ChartInterference.Modes.length ? interferenceExtras(charts.ChartInterference) : {};
    return { id: name, missing: "No diagram: the case has no speed or no line frequency.", extras };
  }
  if (name === "torque") return { id: name, missing: "No torque curves: the case has no RatedTorque, or no torque against speed.", extras: { height: 340 } };
  if (name === "speed-time") return { id: "speed", missing: wait, extras: { height: 340 }, group: time };
  return { id: "event-curves", missing: "", extras: { height: 280 }, isHalf: true };
}
