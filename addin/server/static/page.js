// Small things that all parts of the page use: elements, numbers in words, tables.

export const { ask, stream, key, setKey } = window.torsionbook;
export const at = id => document.getElementById(id);

/** An element with a text. */
export function made(tag, text = null, className = "") {
  const node = document.createElement(tag);
  if (text !== null) node.textContent = text;
  if (className) node.className = className;
  return node;
}

/** What goes on, in the line under the buttons. */
export function say(text, kind = "") {
  at("progress").textContent = text;
  at("progress").className = kind;
}

export function number(value) {
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
  if (/^Safety factor/.test(header)) return value.toFixed(2); // as the workbook has it
  if (/^Mode \d/.test(header)) return (value + 0).toFixed(3).replace(/^-(0\.0+)$/, "$1"); // a mode shape
  return number(value);
}

/** Rows with a row of headers, whose units stand in brackets; columns for which `minor` holds are marked. */
export function table(rows, missing, minor = () => false) {
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

/** Tables that scroll sideways take the keyboard focus and have a name; the others take no focus. */
export function makeReachable() {
  for (const room of document.querySelectorAll("#results .scroll:not([role])")) new ResizeObserver(() => {
    const scrolls = room.scrollWidth > room.clientWidth + 1;
    for (const [name, value] of [["tabindex", "0"], ["role", "region"], ["aria-label", `${room.closest("section").querySelector("h2").textContent}: ${room.id.replace("-", " ")}`]]) {
      if (scrolls) room.setAttribute(name, value); else room.removeAttribute(name);
    }
  }).observe(room);
}
