// The page: open a model, show it, calculate its start with progress, give the workbook back.
// Inside Office it can take the open workbook; in a browser it is a page like any other.
import { redraw } from "./curves.js";
import { fill, openName, openWorkbook, putBack, resultsOf } from "./open_workbook.js";
import { ask, at, key, made, say, setKey, stream } from "./page.js";
import { show } from "./results.js";


const ENDINGS = /\.(xlsx|xlsm|json)$/i;

/** What is open: the file, its model, and the calculation under way. */
const open = { name: "", bytes: null, model: null, running: null };

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
