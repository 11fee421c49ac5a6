// The page: open a model, show it, calculate its start with progress, give the workbook back.
// Inside Office it can take the open workbook; in a browser it is a page like any other.
import { chosen, redraw } from "./curves.js";
import { drafts, edited, showInputs } from "./inputs.js";
import { forget, recall, remember } from "./kept.js";
import { fill, openName, openWorkbook, putBack, resultsOf } from "./open_workbook.js";
import { ask, at, key, made, makeReachable, say, setKey, stream } from "./page.js";
import { show } from "./results.js";
import { settings, showStudy } from "./study_forms.js";
import { setUp } from "./tools.js";

const ENDINGS = /\.(xlsx|xlsm|json)$/i;

/** What is open: the file as it is now and as it was opened, its model, and the calculation under way. */
let isInExcel = false;
const open = { name: "", bytes: null, original: null, model: null, running: null };

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
  at("close").disabled = isBusy || !open.bytes;
  at("typed").hidden = !open.bytes;
  at("as-opened").hidden = at("compare-opened").hidden = !open.bytes || open.bytes === open.original;
  at("examples").hidden = Boolean(open.bytes) || isInExcel;
  for (const button of at("tools").querySelectorAll("button, #earlier")) button.disabled = isBusy;
  at("here").disabled = at("fill").disabled = isBusy;
  at("put-back").disabled = isBusy || !earlier;
}

/** Open a file; what was open before is closed. */
async function take(name, bytes) {
  if (!ENDINGS.test(name)) { say(`${name} is not a workbook: choose an .xlsx or .xlsm file, or a case .json.`, "bad"); return; }
  drafts.rows = {};
  await load({ name, bytes, original: bytes });
}

/** Take a file as it is now; `isSame` where only numbers in it are others than before. */
async function load({ name, bytes, original }, isSame = false, isAgain = false) {
  if (open.running) open.running.cancel();
  Object.assign(open, { name, bytes, original, model: null });
  if (!isSame) {
    at("results").hidden = true;
    at("document").replaceChildren();
    inputsOf = studyOf = null;
  }
  at("problems").hidden = true;
  busy(false);
  keep();
  if (at("inputs").open) typed();
  if (at("study-inputs").open) typedOfStudy();
  say(`reading ${name}`, "busy");
  try {
    const response = await ask(`/api/v1/model?name=${encodeURIComponent(name)}`, { body: bytes });
    const { model } = await response.json();
    if (open.bytes !== bytes) return; // another one by now
    open.model = model;
  } catch (failed) {
    if (open.bytes !== bytes) return;
    at("results").hidden = true;
    showProblems(failed);
    return;
  }
  await calculate(isAgain);
}

/** Keep what is open over a reload. */
function keep() {
  const { name, bytes, original } = open;
  if (bytes && !isInExcel) remember({ name, bytes, original, chosen: chosen.names, drafts: drafts.rows, settings: settings.of });
}
chosen.changed = drafts.changed = settings.changed = keep;

async function close() {
  if (open.running) open.running.cancel();
  Object.assign(open, { name: "", bytes: null, original: null, model: null });
  chosen.names = [];
  drafts.rows = {};
  settings.of = {};
  at("results").hidden = at("problems").hidden = true;
  at("handle").textContent = "";
  busy(false);
  await forget();
  say("Closed; nothing of it is kept in this browser.");
}

// --- inputs that are changed here -----------------------------------------------------------------

/** The file whose inputs are drawn, that and the study whose forms are, and the last change. */
let inputsOf = null, studyOf = null, lastChange = Promise.resolve();

/** Who draws inputs says what was typed; of a study its name. */
const hostOf = (study, draw) => ({
  change: (name, value, wrong) => {
    if (wrong) { say(wrong, "bad"); return Promise.resolve(false); }
    return edit({ [name]: value }, `${name}: changing`, study);
  },
  async changeRows(changes, words, table, row = Infinity) {
    const isDone = await edit(changes, words, study);
    if (isDone) {
      inputsOf = studyOf = null;
      await draw();
      focusIn(table, row);
    }
    return isDone;
  },
  refuse: sentence => say(sentence, "bad"),
});

/** The row that took the place of one that was removed has the focus, or what adds one. */
function focusIn(table, row) {
  const block = document.querySelector(`details[open] > .tables [data-table="${table}"]`);
  const places = block ? block.querySelectorAll(".remove") : [];
  const next = places[Math.min(row, places.length - 1)];
  const target = row < Infinity && next ? next : block && block.querySelector(".add");
  if (target) target.focus();
}

/** Draw the inputs, unless they are those that are drawn. */
async function typed() {
  if (!open.bytes || inputsOf === open.original) return;
  inputsOf = open.original;
  try { await showInputs(open.name, open.bytes, hostOf("", typed)); } catch (failed) { inputsOf = null; showProblems(failed); }
}

/** Draw the forms of the study that is chosen, unless they are those that are drawn. */
async function typedOfStudy() {
  const study = at("study").value, mine = { study, original: open.original };
  if (!open.bytes || (studyOf && studyOf.study === study && studyOf.original === open.original)) return;
  studyOf = mine;
  try { await showStudy(study, open.name, open.bytes, hostOf(study, typedOfStudy)); } catch (failed) { studyOf = null; showProblems(failed); }
}

/** Type inputs anew, one change after another, and calculate; whether it was taken. */
function edit(changes, words, study) {
  const done = lastChange.then(async () => {
    const { name: file, bytes, original } = open;
    say(words, "busy");
    try {
      const now = await edited(file, bytes, changes, study);
      if (open.bytes !== bytes) return false;
      load({ name: file, bytes: now, original }, true);
      return true;
    } catch (failed) {
      showProblems(failed);
      return false;
    }
  });
  lastChange = done;
  return done;
}

function asOpened() {
  const { name, original } = open;
  inputsOf = studyOf = null;
  drafts.rows = {};
  return load({ name, bytes: original, original }, true);
}

// --- calculating ----------------------------------------------------------------------------------

async function calculate(isAgain = false) {
  const began = performance.now();
  let isForgotten = false;
  say("calculating", "busy");
  const run = stream({ view: open.model }, { stage: text => say(text, "busy"), partial: view => show(view, open.name) });
  open.running = run;
  busy(true);
  try {
    show(await run.done, open.name);
    say(`Calculated in ${((performance.now() - began) / 1000).toFixed(1)} s.`);
  } catch (failed) {
    if (failed.forgotten && !isAgain) isForgotten = true; // by a server that was started anew
    else if (failed.cancelled) say("Cancelled. Results that need no start are shown below.");
    else showProblems(failed);
  } finally {
    if (open.running === run) { open.running = null; busy(false); }
  }
  if (isForgotten) await load(open, true, true);
}

/** Something that can be cancelled; what is wrong with it is said. `over`: what is said when it was. */
async function during(work, over = "Cancelled.", name = open.name) {
  if (open.running) return;
  const control = new AbortController(), began = performance.now();
  const run = { cancel: () => control.abort() };
  open.running = run;
  at("problems").hidden = true;
  busy(true);
  say("asking the server", "busy");
  try {
    const done = await work({ signal: control.signal, stage: text => say(text, "busy") });
    say(`${done.replace(/\.$/, "")} (${((performance.now() - began) / 1000).toFixed(1)} s).`);
  } catch (failed) {
    if (failed.name === "AbortError" || failed.cancelled) say(over); else showProblems(failed, name);
  } finally {
    if (open.running === run) { open.running = null; busy(false); }
  }
}

const download = () => during(async ({ signal }) => {
  say("recalculating the workbook", "busy");
  const response = await ask(`/api/v1/workbook?name=${encodeURIComponent(open.name)}`, { body: open.bytes, signal });
  const link = made("a");
  link.href = URL.createObjectURL(await response.blob());
  link.download = open.name.replace(/(\.xls[xm])$/i, ".out$1");
  link.click();
  setTimeout(() => URL.revokeObjectURL(link.href), 10000);
  return `${link.download} is in your downloads.`;
});

async function takeFile(file) {
  if (file) await take(file.name, await file.arrayBuffer());
}

at("file").addEventListener("change", event => takeFile(event.target.files[0]).finally(() => { event.target.value = ""; }));
at("calculate").addEventListener("click", () => calculate());
at("cancel").addEventListener("click", () => open.running && open.running.cancel());
at("download").addEventListener("click", download);
at("print").addEventListener("click", () => window.print());
at("close").addEventListener("click", close);
at("as-opened").addEventListener("click", asOpened);
at("inputs").addEventListener("toggle", () => { if (at("inputs").open) typed(); });
for (const [id, kind] of [["study-inputs", "toggle"], ["study", "change"]]) {
  at(id).addEventListener(kind, () => { if (at("study-inputs").open) typedOfStudy(); });
}
setUp(() => open, during);
for (const kind of ["dragover", "dragleave", "drop"]) {
  addEventListener(kind, event => { // anywhere: a file beside the box would be opened instead of the page
    event.preventDefault();
    document.body.classList.toggle("over", kind === "dragover");
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
    if (innerWidth !== drawnAt) { drawnAt = innerWidth; redraw(); }
  }, 150);
});
addEventListener("beforeprint", () => redraw(true));
addEventListener("afterprint", () => redraw());

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

const inExcel = work => {
  at("written").hidden = true;
  return during(work, "Cancelled. The workbook is as it was.", openName());
};

const percent = share => `${Math.round(100 * share)} %`;

const fillOpen = () => inExcel(async ({ signal, stage }) => {
  const isOver = () => signal.aborted;
  say("reading the open workbook", "busy");
  const bytes = await openWorkbook();
  const { value, warnings } = await resultsOf(ask, openName(), bytes, { signal, stage });
  say("writing results", "busy");
  earlier = await fill(value, share => say(`writing results, ${percent(share)}`, "busy"), isOver);
  at("written").replaceChildren(...warnings.map(text => made("li", text)));
  at("written").hidden = !warnings.length;
  return `${value.cells.toLocaleString("en-US")} result cells on ${value.sheets.length} sheets were written`;
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
      isInExcel = true;
      busy(false);
      at("in-excel").hidden = false;
      at("here").hidden = false;
      at("here").addEventListener("click", takeOpen);
      at("fill").addEventListener("click", fillOpen);
      at("put-back").addEventListener("click", putBackOpen);
    }
  });
}

// --- what is there at the beginning ---------------------------------------------------------------

async function examples() {
  const described = await (await fetch("/examples.json")).json();
  at("examples").querySelector("ul").replaceChildren(...Object.entries(described).map(([name, words]) => {
    const item = made("li"), button = made("button", words);
    button.type = "button";
    button.addEventListener("click", async () => take(`${name}.xlsx`, await (await fetch(`/examples/${name}.xlsx`)).arrayBuffer()));
    item.append(button);
    return item;
  }));
}

/** What was open before a reload is open again; in Office the workbook is there anyway. */
async function begin() {
  busy(false);
  if (window.Office) return;
  examples().catch(() => {});
  const kept = await recall();
  if (!kept || open.bytes) return;
  chosen.names = kept.chosen || [];
  drafts.rows = kept.drafts || {};
  settings.of = kept.settings || {};
  const isEdited = kept.bytes.byteLength !== kept.original.byteLength || !isEqual(kept.bytes, kept.original);
  await load({ name: kept.name, bytes: isEdited ? kept.bytes : kept.original, original: kept.original });
}

const isEqual = (a, b) => { const other = new Uint8Array(b); return new Uint8Array(a).every((byte, i) => byte === other[i]); };

makeReachable();
begin();
fetch("/version").then(response => response.json()).then(about => { at("version").textContent = `${about.name} ${about.version}`; }, () => {});
