// The page: open a model, show it, calculate its start with progress, give the workbook back.
// Inside Office it can take the open workbook; in a browser it is a page like any other.
import { chart, fromRecord, schematic, train } from "./charts.js";
import { fill, openName, openWorkbook, putBack, resultsOf } from "./open_workbook.js";

const { ask, stream, key, setKey } = window.torsionbook;
const at = id => document.getElementById(id);
const ENDINGS = /\.(xlsx|xlsm|json)$/i;

/** Margins shown at once. */
const FEW = 12;
/** Modes whose shapes are shown, and in the narrow pane of Office. */
const SHAPES = 6, FEW_SHAPES = 4;
/** Widths of charts on paper: across the page and half of it. [px] */
const PAPER = { whole: 660, half: 345 };
/** What is open: the file, its model, what is shown of it, and the calculation under way. */
const open = { name: "", bytes: null, model: null, running: null, view: null };

// --- small things ---------------------------------------------------------------------------------

function made(tag, text = null, className = "") {
  const node = document.createElement(tag);
  if (text !== null) node.textContent = text;
  if (className) node.className = className;
  return node;
}

function say(text, kind = "") {
  at("progress").textContent = text;
  at("progress").className = kind;
}

function number(value) {
  if (value === 0) return "0"; // and not -0
  if (Number.isInteger(value) && Math.abs(value) < 1e9) return value.toLocaleString("en-US");
  const size = Math.abs(value);
  if (size >= 1e9 || (size < 1e-4 && size > 0)) return value.toExponential(3);
  if (size >= 1e5) return Math.round(value).toLocaleString("en-US");
  return Number(value.toPrecision(5)).toLocaleString("en-US", { maximumFractionDigits: 10 });
}

function verdictClass(text) {
  if (/^(fail|check|no$)/i.test(text)) return "fail";
  if (/^(accepted|pass within)/i.test(text)) return "accepted";
  return /^pass/i.test(text) ? "pass" : "";
}

/** How a value is shown; starts are whole ones, as in the verdict. */
function shown(value, header) {
  if (value === null) return "";
  if (typeof value === "boolean") return value ? "yes" : "no";
  if (typeof value !== "number") return value;
  if (/^(Allowable starts|Paper count)/.test(header)) return number(Math.floor(value * (1 + 1e-9)));
  if (/^Mode \d/.test(header)) return (value + 0).toFixed(3).replace(/^-(0\.0+)$/, "$1"); // a mode shape
  return number(value);
}

/** Rows with a row of headers, whose units stand in brackets; columns for which `minor` holds are marked. */
function table(rows, missing, minor = () => false) {
  if (!rows || rows.length < 2) return made("p", missing, "missing");
  const [head, ...body] = rows;
  const columns = head.map((_, j) => j).filter(j => body.some(row => row[j] !== null));
  const isNumber = j => body.every(row => row[j] === null || typeof row[j] === "number" || row[j] === "unlimited" || row[j] === "unbounded");
  const drawn = made("table"), top = drawn.createTHead().insertRow(), rest = drawn.createTBody();
  const kind = j => `${isNumber(j) ? "number" : ""} ${minor(head[j].replace(/ \[.*/, "")) ? "minor" : ""}`.trim();
  for (const j of columns) {
    const [, name, unit] = /^(.*?)(?: \[(.*)\])?$/.exec(head[j]);
    const cell = made("th", name, kind(j));
    cell.scope = "col";
    if (unit) cell.append(made("span", unit, "unit"));
    top.append(cell);
  }
  for (const row of body) {
    const line = rest.insertRow();
    for (const j of columns) {
      const text = shown(row[j], head[j]);
      const cell = made("td", text, kind(j));
      if (/^Verdict/.test(head[j])) cell.className = `${kind(j)} ${verdictClass(String(text))}`.trim();
      line.append(cell);
    }
  }
  return drawn;
}

/** A table in its place, under its name in the view; where columns are left out in a narrow pane, a button shows them. */
function putTable(id, name, rows, missing) {
  const { minor, workbook } = open.view.left_out[name];
  const isFurtherShape = header => Number((/^Mode (\d+)$/.exec(header) || [])[1]) > FEW_SHAPES;
  const drawn = table(without(rows, workbook), missing, header => minor.includes(header) || isFurtherShape(header));
  at(id).classList.remove("all");
  at(id).replaceChildren(drawn);
  if (!drawn.querySelector(".minor")) return;
  const more = made("button", "All columns", "more noprint");
  more.type = "button";
  more.addEventListener("click", () => { more.textContent = at(id).classList.toggle("all") ? "Fewer columns" : "All columns"; });
  at(id).append(more);
}

/** A table without some of its columns. */
function without(rows, names) {
  if (!rows || !rows.length) return rows;
  const kept = rows[0].map((name, j) => (names.includes(name.replace(/ \[.*/, "")) ? -1 : j)).filter(j => j >= 0);
  return rows.map(row => kept.map(j => row[j]));
}

function figure(id, svg, caption = "") {
  const drawn = made("figure");
  if (caption) {
    const words = made("figcaption");
    words.append(made("b", caption));
    drawn.append(words);
  }
  drawn.append(svg);
  at(id).append(drawn);
}

// --- drawing a model ------------------------------------------------------------------------------

function show(view) {
  open.view = view;
  at("results").hidden = false;
  at("results").classList.toggle("waiting", !view.complete);
  at("title").textContent = view.about.title || open.name || "Model";
  at("handle").textContent = view.handle;
  showAbout(view);
  const { charts, labels, tables } = view, wait = waiting(view);
  at("verdicts").replaceChildren(view.complete ? table(tables.Verdicts, "No verdicts.") : "");
  at("schematic").replaceChildren(schematic(view.schematic) || "");
  at("train").replaceChildren(drawnTrain(charts.ChartTrain, labels));
  putTable("frequencies", "NaturalFrequencies", tables.NaturalFrequencies, "No modes.");
  putTable("shapes", "ModeShapes", (tables.ModeShapes || []).map(row => row.slice(0, SHAPES + 1)), "No modes.");
  showCharts(view);
  putTable("peaks", "StartupPeaks", tables.StartupPeaks, wait);
  putTable("reversals", "TorqueReversals", tables.TorqueReversals, view.complete ? "No start, or no gear mesh and no geared coupling." : wait);
  putTable("starts", "AllowableStarts", tables.AllowableStarts, view.complete ? "No start, or no shaft is judged for fatigue: give Material, Stress diameter and S-N points." : wait);
  const { EventPeaks: peaks = [], AirGapTorque: airGap = [] } = tables;
  at("events").hidden = peaks.length < 2 && airGap.length < 2;
  putTable("event-peaks", "EventPeaks", peaks, "No events.");
  putTable("air-gap", "AirGapTorque", airGap, "No motor in time.");
  showMargins(tables.SeparationMargins);
  showSteady(tables.SteadyState);
  showNotes(view.warnings);
}

const waiting = view => (view.complete ? "None." : "Not calculated yet.");

/** The charts, drawn for the width they are shown at: on the screen, or on paper. */
function showCharts({ charts, drawn, complete }, onPaper = false) {
  for (const id of ["interference", "torque", "speed", "histories"]) at(id).replaceChildren();
  const wait = waiting({ complete }), inHalf = matchMedia("(min-width: 48rem)").matches;
  const room = (id, parts) => Math.round(Math.max(270, Math.min(640, at(id).clientWidth / parts - (parts > 1 ? 16 : 0))));
  const width = (id, parts = 1) => (onPaper ? PAPER[id === "interference" ? "whole" : "half"] : room(id, parts));
  for (const record of drawn) {
    const { id, missing, extras } = placeOf(record.name, charts, wait);
    const parts = id === "histories" && inHalf ? 2 : 1;
    const what = fromRecord(record, charts, extras);
    if (what) figure(id, chart({ ...what, width: width(id, parts) }), id === "histories" ? record.title : undefined);
    else if (missing) at(id).append(made("p", missing, "missing"));
  }
  if (!at("histories").children.length) at("histories").append(made("p", wait, "missing"));
}

function showAbout(view) {
  at("about").replaceChildren();
  const words = { tag: "Tag", client: "Client", document: "Document", revision: "Revision", prepared_by: "Prepared by", checked_by: "Checked by" };
  for (const [name, word] of Object.entries(words)) {
    if (!view.about[name]) continue;
    const pair = made("div");
    pair.append(made("dt", word), made("dd", view.about[name]));
    at("about").append(pair);
  }
  at("outcome").textContent = view.complete ? view.sentence || `Outcome: ${view.outcome}.` : "";
}

/** Those that fail and the nearest others; a long train has hundreds. */
function showMargins(rows, all = false) {
  const [head, ...body] = rows, margin = head.findIndex(name => /^Margin/.test(name)), verdict = head.indexOf("Verdict");
  const nearest = [...body].sort((a, b) => a[margin] - b[margin]);
  const few = nearest.filter((row, i) => i < FEW || row[verdict] !== "pass");
  const shown = all ? body : few;
  putTable("margins", "SeparationMargins", [head, ...shown], "Nothing is judged: the case has no speed and no line frequency. Type LineFrequency and Poles, or SynchronousSpeed.");
  at("all-margins").hidden = all || shown.length === body.length;
  at("all-margins").textContent = `Show all ${body.length}, not only the ${few.length} nearest`;
  at("all-margins").onclick = () => showMargins(rows, true);
}

/** Judged elements, those that fail first; most elements have no limit and are not judged. */
function showSteady([head, ...body]) {
  const verdict = head.indexOf("Verdict"), fails = row => (row[verdict] === "fail" ? 0 : 1);
  const judged = body.filter(row => row[verdict] !== "not judged").sort((a, b) => fails(a) - fails(b));
  putTable("steady", "SteadyState", [head, ...judged], body.length ? "No element is judged: none has a limit, or the loads are unknown." : "No forced response: no excitation has a known torque and frequency.");
  const left = body.length - judged.length;
  if (left && judged.length) at("steady").append(made("p", `${left} rows that are not judged are hidden here; a workbook with results lists them.`, "missing"));
}

function showNotes(sentences) {
  const list = at("notes").querySelector("ul");
  list.replaceChildren(...sentences.map(sentence => made("li", sentence)));
  at("notes").hidden = !sentences.length;
}

function drawnTrain(columns, labels) {
  const items = columns.Item.map((name, i) => {
    for (let k = 1; k <= 4; k += 1) {
      for (const [kind, word] of [["disc", "Disc"], ["shaft", "Shaft"]]) {
        const height = columns[`${word} up ${k}`][i];
        if (typeof height === "number") return { name, kind, height, group: k - 1 };
      }
    }
    const mesh = columns["Mesh up"][i];
    return typeof mesh === "number" ? { name, kind: "mesh", height: mesh, group: 0 } : { name: "", kind: "gap", height: 0, group: 0 };
  });
  const groups = [1, 2, 3, 4].map(k => String(labels[`Speed group ${k}`] ?? "").trim()).filter(Boolean);
  return train(items, groups);
}

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
  if (name === "speed-time") return { id: "speed", missing: wait, extras: { height: 340 } };
  return { id: "histories", missing: "", extras: { height: 250 } };
}

// --- what the engineer does -----------------------------------------------------------------------

function showProblems(failed, name = open.name) {
  const errors = (failed.content || {}).errors || [];
  at("problems").querySelector("ol").replaceChildren(...errors.map(error => made("li", error.message)));
  at("problems").hidden = !errors.length;
  say(errors.length ? `${name}: ${errors.length === 1 ? "one error" : `${errors.length} errors`}.` : failed.message, "bad");
  if (failed.status === 401) at("connection").open = true;
}

function busy(isBusy) {
  at("cancel").hidden = !isBusy;
  at("calculate").disabled = isBusy || !open.model;
  at("download").disabled = isBusy || !open.model || /\.json$/i.test(open.name);
  at("print").disabled = isBusy || !open.model;
  at("here").disabled = at("fill").disabled = isBusy;
  at("put-back").disabled = isBusy || !earlier;
}

async function take(name, bytes, isAgain = false) {
  if (open.running) open.running.cancel();
  Object.assign(open, { name, bytes, model: null });
  at("results").hidden = true;
  at("problems").hidden = true;
  busy(false);
  if (!ENDINGS.test(name)) { say(`${name} is not a workbook: choose an .xlsx or .xlsm file, or a case .json.`, "bad"); return; }
  say(`reading ${name}`, "busy");
  try {
    const response = await ask(`/api/v1/model?name=${encodeURIComponent(name)}`, { body: bytes });
    open.model = (await response.json()).model;
  } catch (failed) {
    showProblems(failed);
    return;
  }
  await calculate(isAgain);
}

async function calculate(isAgain = false) {
  const began = performance.now();
  let isForgotten = false;
  say("calculating", "busy");
  const run = stream({ view: open.model }, { stage: text => say(text, "busy"), partial: show });
  open.running = run;
  busy(true);
  try {
    show(await run.done);
    say(`Calculated in ${((performance.now() - began) / 1000).toFixed(1)} s.`);
  } catch (failed) {
    if (failed.forgotten && !isAgain) isForgotten = true; // by a server that was started anew
    else if (failed.cancelled) say("Cancelled. Results that need no start are shown below.");
    else showProblems(failed);
  } finally {
    if (open.running === run) { open.running = null; busy(false); }
  }
  if (isForgotten) await take(open.name, open.bytes, true);
}

async function download() {
  const control = new AbortController();
  const run = { cancel: () => control.abort() };
  open.running = run;
  busy(true);
  say("recalculating the workbook", "busy");
  try {
    const response = await ask(`/api/v1/workbook?name=${encodeURIComponent(open.name)}`, { body: open.bytes, signal: control.signal });
    const link = made("a");
    link.href = URL.createObjectURL(await response.blob());
    link.download = open.name.replace(/(\.xls[xm])$/i, ".out$1");
    link.click();
    setTimeout(() => URL.revokeObjectURL(link.href), 10000);
    say(`${link.download} is in your downloads.`);
  } catch (failed) {
    if (failed.name === "AbortError") say("Cancelled."); else showProblems(failed);
  } finally {
    open.running = null;
    busy(false);
  }
}

async function takeFile(file) {
  if (file) await take(file.name, await file.arrayBuffer());
}

at("file").addEventListener("change", event => takeFile(event.target.files[0]).finally(() => { event.target.value = ""; }));
at("calculate").addEventListener("click", () => calculate());
at("cancel").addEventListener("click", () => open.running && open.running.cancel());
at("download").addEventListener("click", download);
at("print").addEventListener("click", () => window.print());
for (const kind of ["dragover", "dragleave", "drop"]) {
  at("drop").addEventListener(kind, event => {
    event.preventDefault();
    at("drop").classList.toggle("over", kind === "dragover");
    if (kind === "drop") takeFile(event.dataTransfer.files[0]);
  });
}
at("key").value = key();
at("key-form").addEventListener("submit", event => {
  event.preventDefault();
  setKey(at("key").value);
  checkKey();
});

/** Say whether the server takes the key that is kept. */
async function checkKey() {
  say("checking the key with the server", "busy");
  try {
    await ask("/api/v1/batch", { body: JSON.stringify({ calls: [] }), headers: { "Content-Type": "application/json" } });
    at("connection").open = false;
    say(key() ? "The key is saved in this browser, and the server accepts it." : "No key is saved; the server needs none.");
  } catch (failed) {
    if (failed.status !== 401) say(`The key is saved but could not be checked: ${failed.message}`, "bad");
    else if (key()) say("The server does not accept this key: it is wrong, mistyped or withdrawn. Ask the administrator of the server for a valid one.", "bad");
    else say("No key is saved, but the server needs one. Ask the administrator of the server for it.", "bad");
  }
}

// charts fit where they are shown: drawn anew when the pane is made wider, and for paper
let drawnAt = innerWidth, redrawing = null;
addEventListener("resize", () => {
  clearTimeout(redrawing);
  redrawing = setTimeout(() => {
    if (open.view && innerWidth !== drawnAt) { drawnAt = innerWidth; showCharts(open.view); }
  }, 150);
});
addEventListener("beforeprint", () => { if (open.view) showCharts(open.view, true); });
addEventListener("afterprint", () => { if (open.view) showCharts(open.view); });

// --- inside Office --------------------------------------------------------------------------------

/** Sheets with the cells that stood there before they were filled; null where nothing is to be put back. */
let earlier = null;

async function takeOpen() {
  say("reading the open workbook", "busy");
  try {
    await take(openName(), await openWorkbook());
  } catch (failed) {
    say(`Office did not provide the workbook; save it and try again: ${failed.message}`, "bad");
  }
}

/** Something done with the open workbook that can be cancelled; what is wrong with it is said. */
async function inExcel(work) {
  if (open.running) return;
  const control = new AbortController(), began = performance.now();
  const run = { cancel: () => control.abort() };
  open.running = run;
  at("problems").hidden = true;
  at("written").hidden = true;
  busy(true);
  try {
    const done = await work(control.signal);
    say(`${done} in ${((performance.now() - began) / 1000).toFixed(1)} s.`);
  } catch (failed) {
    if (failed.name === "AbortError" || failed.cancelled) say("Cancelled. The workbook is as it was.");
    else showProblems(failed, openName());
  } finally {
    if (open.running === run) { open.running = null; busy(false); }
  }
}

const percent = share => `${Math.round(100 * share)} %`;

const fillOpen = () => inExcel(async signal => {
  const isOver = () => signal.aborted;
  say("reading the open workbook", "busy");
  const bytes = await openWorkbook();
  const { value, warnings } = await resultsOf(ask, openName(), bytes, { signal, stage: text => say(text, "busy") });
  say("writing results", "busy");
  earlier = await fill(value, share => say(`writing results, ${percent(share)}`, "busy"), isOver);
  at("written").replaceChildren(...warnings.map(text => made("li", text)));
  at("written").hidden = !warnings.length;
  return `${value.cells.toLocaleString("en-US")} result cells on ${value.sheets.length} sheets written`;
});

const putBackOpen = () => inExcel(async () => {
  at("cancel").hidden = true; // half of it would be neither
  await putBack(earlier, share => say(`writing the earlier values back, ${percent(share)}`, "busy"));
  earlier = null;
  return "The earlier values were written back";
});

if (window.Office) {
  Office.onReady(info => {
    if (info && info.host === "Excel") {
      at("in-excel").hidden = false;
      at("here").hidden = false;
      at("here").addEventListener("click", takeOpen);
      at("fill").addEventListener("click", fillOpen);
      at("put-back").addEventListener("click", putBackOpen);
    }
  });
}

fetch("/version").then(response => response.json()).then(about => { at("version").textContent = `${about.name} ${about.version}`; }, () => {});
