// The inputs of the open file as they are typed, to be changed here. The server writes them into a copy of the file.
import { ask, at, made } from "./page.js";

/** Rows of a table that are shown. [count] */
const MOST_ROWS = 200;

/** Tables that are unfolded, and rows that are typed but not entered: texts by table and column. */
export const unfolded = new Set();
export const drafts = { rows: {}, changed() {} };

const shownUnit = unit => (unit === "1" ? "" : unit);

/** What is asked of the inputs of a file, or of those of a study. */
export function inputsAddress(path, name, study, more = {}) {
  return `/api/v1/${path}?${new URLSearchParams({ name, ...(study ? { study } : {}), ...more })}`;
}

/** The file with other values in some inputs. */
export async function edited(name, bytes, changes, study = "") {
  const response = await ask(inputsAddress("edited", name, study, { changes: JSON.stringify(changes) }), { body: bytes });
  return response.arrayBuffer();
}

/** Draw the inputs of a file. host.change: called with the name of an input and its new value; a promise of whether it was
 *  taken. host.changeRows: the same with a row added or removed, after which the tables are drawn anew. */
export async function showInputs(name, bytes, host) {
  const response = await ask(inputsAddress("inputs", name, ""), { body: bytes });
  const { scalars, tables } = await response.json();
  at("scalars").replaceChildren(...scalars.map(one => {
    const label = made("label", one.name);
    label.title = one.help;
    label.append(field(one, one.name, one, host.change));
    const unit = shownUnit(one.unit);
    if (unit || one.number) label.append(made("span", unit, "unit")); else label.className = "text";
    return label;
  }));
  at("tables").replaceChildren(...tables.map(one => drawnTable(one, host)));
}

/** A table of inputs, folded unless it was unfolded before. */
export function drawnTable(table, host) {
  const { name, help, rows } = table, block = made("details");
  block.dataset.table = name;
  block.append(made("summary", `${name} (${rows.length === 0 ? "no rows" : rows.length === 1 ? "1 row" : `${rows.length} rows`})`));
  const unfold = () => {
    if (block.open && block.children.length === 1) block.append(...contentOf(table, help, host));
    if (block.open) unfolded.add(name); else unfolded.delete(name);
  };
  block.addEventListener("toggle", unfold);
  if (drafts.rows[name]) unfolded.add(name);
  if (unfolded.has(name)) { block.open = true; unfold(); }
  return block;
}

function contentOf(table, help, host) {
  const { name, columns, rows } = table, scroll = made("div", null, "scroll");
  scroll.tabIndex = 0;
  scroll.setAttribute("role", "region");
  scroll.setAttribute("aria-label", name);
  const buttons = made("div", null, "row");
  const button = (words, act) => { const one = made("button", words); one.type = "button"; one.addEventListener("click", act); buttons.append(one); return one; };
  let isWhole = !rows.length || Boolean(drafts.rows[name]);
  const draw = () => {
    const isTyping = Boolean(drafts.rows[name]);
    scroll.replaceChildren(...cellsOf(table, isWhole, host, { enter, discard }));
    all.hidden = isWhole || columns.every(column => column.used);
    scroll.hidden = !rows.length && !isTyping;
    add.hidden = isTyping;
    into.hidden = away.hidden = !isTyping;
  };
  const add = button("Add a row", () => {
    isWhole = true;
    drafts.rows[name] = {};
    drafts.changed();
    draw();
    scroll.querySelector(".draft input, .draft select").focus();
  });
  add.className = "add";
  const enter = async () => {
    const row = typedRow(columns, scroll, name, host);
    if (!row) return;
    const draft = drafts.rows[name];
    delete drafts.rows[name]; // the tables are drawn anew before the answer comes back here
    if (!await host.changeRows({ [`${name}[+]`]: row }, `${name}: adding a row`, name)) drafts.rows[name] = draft;
    drafts.changed();
  };
  const discard = () => {
    delete drafts.rows[name];
    drafts.changed();
    draw();
    add.focus();
  };
  const into = button("Enter the row", enter), away = button("Discard the row", discard);
  const all = button("All columns", () => { isWhole = true; draw(); scroll.focus(); });
  draw();
  const left = rows.length - MOST_ROWS;
  return [
    made("p", help, "hint"), scroll, buttons,
    ...(left > 0 ? [made("p", `${left} further rows: change them in the workbook.`, "hint")] : []),
  ];
}

/** Columns that are shown: all, or those with an entry; of each its place among all. */
const shownColumns = (columns, isWhole) => columns.map((column, j) => [column, j]).filter(([column]) => isWhole || column.used);

function cellsOf({ name, columns, rows }, isWhole, host, { enter, discard }) {
  const drawn = made("table"), head = drawn.createTHead().insertRow(), body = drawn.createTBody();
  const shown = shownColumns(columns, isWhole);
  for (const [column, j] of shown) {
    const units = new Set((rows.length ? rows.map(row => row.cells[j].unit) : [column.unit]).map(shownUnit));
    const cell = made("th", column.name);
    cell.scope = "col";
    cell.title = column.help;
    if ([...units].some(Boolean)) cell.append(made("span", [...units].join(", "), "unit"));
    head.append(cell);
  }
  head.append(made("td"));
  rows.slice(0, MOST_ROWS).forEach((row, i) => {
    const line = body.insertRow();
    for (const [column, j] of shown) {
      const input = field(row.cells[j], `${name}[${row.name}].${column.name}`, column, host.change);
      input.setAttribute("aria-label", `${column.name} of ${row.name}`);
      line.insertCell().append(input);
    }
    const remove = made("button", "Remove", "remove");
    remove.type = "button";
    remove.setAttribute("aria-label", `Remove ${row.name}`);
    remove.addEventListener("click", () => host.changeRows({ [`${name}[${row.name}]`]: null }, `${name}: removing ${row.name}`, name, i));
    line.insertCell().append(remove);
  });
  const draft = drafts.rows[name];
  if (draft) {
    const line = body.insertRow();
    line.className = "draft";
    for (const [column] of shown) {
      const input = emptyField(column, draft[column.name] || "");
      input.dataset.column = column.name;
      input.setAttribute("aria-label", `${column.name} of the new row`);
      input.addEventListener("input", () => { draft[column.name] = input.value; drafts.changed(); });
      input.addEventListener("keydown", event => {
        if (event.key === "Enter") { event.preventDefault(); enter(); }
        if (event.key === "Escape") discard();
      });
      line.insertCell().append(input);
    }
    line.insertCell();
  }
  return [drawn];
}

/** The cells of the row that is typed; null where one of them is wrong or all are blank. */
function typedRow(columns, scroll, table, { refuse }) {
  const row = {};
  for (const input of scroll.querySelectorAll(".draft [data-column]")) {
    const column = columns.find(one => one.name === input.dataset.column), { wrong, value } = typedValue(input, column);
    input.setAttribute("aria-invalid", String(wrong));
    if (wrong) { refuse(`${column.name} of the new row: '${input.value}' is no number. Use a decimal point.`); input.focus(); return null; }
    if (value !== null) row[column.name] = value;
  }
  if (!Object.keys(row).length) { refuse(`${table}: type something into the new row.`); return null; }
  return row;
}

/** What is typed in a field, and whether it is no number where one is wanted. */
function typedValue(input, { number, choices }) {
  const text = input.value.trim(), asNumber = Number(text), isWord = choices.includes(text);
  const wrong = Boolean(number && text && !isWord && !Number.isFinite(asNumber));
  return { text, wrong, value: text === "" ? null : number && !isWord ? asNumber : text };
}

/** A field to type in: words that may be chosen, a number, or a text. */
function emptyField({ number, choices }, value) {
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
  input.value = value;
  return input;
}

/** A field that changes the file. */
function field({ value }, name, column, change) {
  let before = value === null ? "" : String(value);
  const input = emptyField(column, before);
  input.addEventListener("change", async () => {
    const { text, wrong, value: typed } = typedValue(input, column);
    if (text === before) return;
    input.setAttribute("aria-invalid", String(wrong));
    const taken = await change(name, typed, wrong ? `${name}: '${text}' is no number. Use a decimal point.` : "");
    if (taken) before = text; else if (!wrong) input.value = before;
  });
  return input;
}
