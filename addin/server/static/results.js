// What is known of a model, as tables and pictures: first without its start, then with it.
import { schematic, train } from "./charts.js";
import { showCurves } from "./curves.js";
import { showMotion } from "./motion.js";
import { at, made, table } from "./page.js";

/** Margins shown at once. */
const FEW = 12;
/** Modes whose shapes are shown, and in the narrow pane of Office. */
const SHAPES = 6, FEW_SHAPES = 4;
/** Columns that tables leave out, by the name of the table. */
let leftOut = {};

/** A table in its place, under its name in the view; where columns are left out in a narrow pane, a button shows them. */
function putTable(id, name, rows, missing) {
  const { minor, workbook } = leftOut[name];
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

/** Show a view of a model: without its start, or with it. */
export function show(view, name) {
  leftOut = view.left_out;
  at("results").hidden = false;
  at("results").classList.toggle("waiting", !view.complete);
  at("title").textContent = view.about.title || name || "Model";
  at("handle").textContent = view.handle;
  showAbout(view);
  const { charts, labels, tables } = view, wait = waiting(view);
  at("verdicts").replaceChildren(view.complete ? table(tables.Verdicts, "No verdicts.") : "");
  at("schematic").replaceChildren(schematic(view.schematic) || "");
  at("train").replaceChildren(drawnTrain(charts.ChartTrain, labels));
  putTable("frequencies", "NaturalFrequencies", tables.NaturalFrequencies, "No modes.");
  putTable("shapes", "ModeShapes", (tables.ModeShapes || []).map(row => row.slice(0, SHAPES + 1)), "No modes.");
  showMotion(tables.ModeShapes || [], charts.ChartTrain.Item, tables.NaturalFrequencies || []);
  showCurves(view, view.handle);
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
