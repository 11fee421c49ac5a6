// The inputs of the open file as they are typed, to be changed here. The server writes them into a copy of the file.
import { ask, at, made } from "./page.js";

/** Rows of a table that are shown. [count] */
const MOST_ROWS = 200;

const shownUnit = unit => (unit === "1" ? "" : unit);

/** The file with other values in some inputs. */
export async function edited(name, bytes, changes) {
  const query = `name=${encodeURIComponent(name)}&changes=${encodeURIComponent(JSON.stringify(changes))}`;
  const response = await ask(`/api/v1/edited?${query}`, { body: bytes });
  return response.arrayBuffer();
}

/** Draw the inputs of a file. change: called with the name of an input and its new value; a promise of whether it was taken. */
export async function showInputs(name, bytes, change) {
  const response = await ask(`/api/v1/inputs?name=${encodeURIComponent(name)}`, { body: bytes });
  const { scalars, tables } = await response.json();
  at("scalars").replaceChildren(...scalars.map(one => {
    const label = made("label", one.name);
    label.title = one.help;
    label.append(field(one, one.name, one, change), made("span", shownUnit(one.unit), "unit"));
    return label;
  }));
  at("tables").replaceChildren(...tables.map(one => drawnTable(one, change)));
}

function drawnTable({ name, columns, rows }, change) {
  const block = made("details"), scroll = made("div", null, "scroll");
  block.append(made("summary", `${name} (${rows.length} ${rows.length === 1 ? "row" : "rows"})`), scroll);
  scroll.tabIndex = 0;
  scroll.setAttribute("role", "region");
  scroll.setAttribute("aria-label", name);
  block.addEventListener("toggle", () => { if (block.open && !scroll.firstChild) scroll.append(...cellsOf(name, columns, rows, change)); });
  return block;
}

function cellsOf(name, columns, rows, change) {
  const drawn = made("table"), head = drawn.createTHead().insertRow(), body = drawn.createTBody();
  columns.forEach((column, j) => {
    const units = new Set(rows.map(row => shownUnit(row.cells[j].unit)));
    const cell = made("th", column.name);
    cell.scope = "col";
    cell.title = column.help;
    if ([...units].some(Boolean)) cell.append(made("span", [...units].join(", "), "unit"));
    head.append(cell);
  });
  for (const row of rows.slice(0, MOST_ROWS)) {
    const line = body.insertRow();
    row.cells.forEach((cell, j) => {
      const place = `${name}[${row.name}].${columns[j].name}`, input = field(cell, place, columns[j], change);
      input.setAttribute("aria-label", `${columns[j].name} of ${row.name}`);
      line.insertCell().append(input);
    });
  }
  const left = rows.length - MOST_ROWS;
  return left > 0 ? [drawn, made("p", `${left} further rows: change them in the workbook.`, "hint")] : [drawn];
}

/** A value to type in: words that may be chosen, a number, or a text. */
function field({ value }, name, { number, choices }, change) {
  const isChoice = choices.length && !number;
  const input = made(isChoice ? "select" : "input");
  if (isChoice) {
    const words = ["", ...choices, ...(value && !choices.includes(value) ? [value] : [])];
    input.append(...words.map(word => Object.assign(made("option", word), { value: word })));
  } else {
    input.type = "text";
    input.autocomplete = "off";
    if (number) input.inputMode = "decimal";
  }
  let before = value === null ? "" : String(value);
  input.value = before;
  input.addEventListener("change", async () => {
    const text = input.value.trim(), asNumber = Number(text);
    if (text === before) return;
    const isWord = choices.includes(text);
    const wrong = number && text && !isWord && !Number.isFinite(asNumber);
    input.setAttribute("aria-invalid", String(Boolean(wrong)));
    const typed = text === "" ? null : number && !isWord ? asNumber : text;
    const taken = await change(name, typed, wrong ? `${name}: '${text}' is no number. Use a decimal point.` : "");
    if (taken) before = text; else if (!wrong) input.value = before;
  });
  return input;
}
