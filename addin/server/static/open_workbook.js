// The workbook that is open in Excel: read as a file, recalculated by the server, filled through Excel's own
// interface, and put back as it was. What is written where comes from the server; nothing is decided here.
//
// Of Office.js it uses what ExcelApi 1.13 has, as the manifest asks for; tests hold it to that.

import { lastLine } from "./lines.js";

/** Cells that Excel is handed at once: one sheet, unless it has more; 5 MB is what Excel on the web takes. [count] */
const PORTION = 50000;

const wrong = message => ({ message });
const cancelled = () => Object.assign(wrong("Cancelled."), { cancelled: true });

/** The open workbook as a file, piece by piece as Office hands it over. */
export async function openWorkbook() {
  const promised = (object, method, ...given) => new Promise((resolve, reject) => {
    object[method](...given, answer => (answer.status === "failed" ? reject(answer.error) : resolve(answer.value)));
  });
  const file = await promised(Office.context.document, "getFileAsync", Office.FileType.Compressed, { sliceSize: 1 << 20 });
  try {
    const bytes = new Uint8Array(file.size);
    let offset = 0;
    for (let i = 0; i < file.sliceCount; i += 1) {
      const { data } = await promised(file, "getSliceAsync", i);
      bytes.set(data, offset);
      offset += data.length;
    }
    return bytes.buffer;
  } finally {
    file.closeAsync(() => {});
  }
}

/** Its name; that of a workbook where Office says none. */
export function openName() {
  const url = Office.context.document.url || "";
  let name = url.split(/[\\/]/).pop();
  try { name = decodeURIComponent(name); } catch { /* a % of its own */ }
  return /\.xls[xm]$/i.test(name) ? name : "workbook.xlsx";
}

/** What to write into a workbook, from the server, which tells its stages. */
export async function resultsOf(ask, name, bytes, { signal, stage }) {
  const response = await ask(`/api/v1/open-workbook?name=${encodeURIComponent(name)}`, { body: bytes, signal });
  return lastLine(response, stage, "Nothing was written");
}

// --- rectangles -----------------------------------------------------------------------------------

/** First and last row of an address such as B7:J22, and its columns. */
function parts(address) {
  const [, left, top, right = left, bottom = top] = /^([A-Z]+)(\d+)(?::([A-Z]+)(\d+))?$/.exec(address);
  return { left, right, top: Number(top), bottom: Number(bottom) };
}

/** Number of a column from its letters. */
const column = letters => [...letters].reduce((sum, letter) => 26 * sum + letter.charCodeAt(0) - 64, 0);

/** An address without its sheet. */
const bare = address => address.slice(address.lastIndexOf("!") + 1).replaceAll("$", "");

/** Rectangles, with their rows if they have any, in pieces that are not too large together: lists of them. */
function portions(blocks) {
  const lists = [[]];
  let taken = 0;
  for (const { at, rows } of blocks) {
    const { left, right, top, bottom } = parts(at), width = column(right) - column(left) + 1;
    for (let first = top; first <= bottom;) {
      if (taken >= PORTION) { lists.push([]); taken = 0; }
      const count = Math.max(1, Math.floor((PORTION - taken) / width)), last = Math.min(bottom, first + count - 1);
      lists.at(-1).push({ at: `${left}${first}:${right}${last}`, rows: rows && rows.slice(first - top, last - top + 1) });
      taken += (last - first + 1) * width;
      first = last + 1;
    }
  }
  return lists;
}

/** A text would be read as if it were typed: an apostrophe before it, which is no part of it, prevents that. */
const typed = text => (/^\p{L}[^\d]*$/u.test(text) && !/^(true|false)$/i.test(text) ? text : `'${text}`);

/** Cells as they have to be written to be the same again: formulas, numbers with all their digits, texts. */
function asWritten({ formulas, values, valueTypes }) {
  return formulas.map((row, i) => row.map((cell, j) => {
    const value = values[i][j];
    if (valueTypes[i][j] === "String" && cell === value) return typed(value);
    return typeof cell === "string" && cell.startsWith("=") ? cell : value;
  }));
}

// --- Excel ----------------------------------------------------------------------------------------

/** Excel neither calculates nor draws until this batch is done. */
function quietly(context) {
  context.application.suspendApiCalculationUntilNextSync();
  context.application.suspendScreenUpdatingUntilNextSync();
}

/** Refuse sheets that are gone or protected, and tables that are not where they are expected, before anything is written. */
async function check(sheets, size, context) {
  const found = sheets.map(({ name }) => context.workbook.worksheets.getItemOrNullObject(name));
  await context.sync();
  const gone = found.findIndex(sheet => sheet.isNullObject);
  if (gone >= 0) throw wrong(`Nothing was written: sheet ${sheets[gone].name} was renamed or deleted meanwhile. Try again.`);
  const tables = sheets.map((sheet, i) => sheet.tables.map(table => ({ table, live: found[i].tables.getItemOrNullObject(table.name) })));
  for (const sheet of found) sheet.protection.load("protected");
  await context.sync();
  const locked = found.findIndex(sheet => sheet.protection.protected);
  if (locked >= 0) {
    throw wrong(`Nothing was written: sheet ${sheets[locked].name} is protected. Remove the protection (Review, Unprotect Sheet) and try again.`);
  }
  for (const one of tables.flat()) {
    one.range = one.live.isNullObject ? null : one.live.getRange();
    if (one.range) one.range.load("address");
  }
  await context.sync();
  const moved = tables.flat().find(({ table, range }) => !range || bare(range.address) !== table[size]);
  if (moved) throw wrong(`Nothing was written: table ${moved.table.name} was moved, resized or deleted meanwhile. Try again.`);
}

/** What stands in the cells that will be written, in the order in which it is put back. */
async function cellsOf(sheet, context) {
  const added = sheet.tables.filter(table => table.added).map(table => table.added);
  const places = [...new Set([...added, ...sheet.cleared, ...sheet.blocks.map(block => block.at)])];
  const blocks = [];
  for (const list of portions(places.map(at => ({ at })))) {
    const ranges = list.map(({ at }) => {
      const range = context.workbook.worksheets.getItem(sheet.name).getRange(at);
      range.load("formulas, values, valueTypes");
      return { at, range };
    });
    await context.sync();
    for (const { at, range } of ranges) blocks.push({ at, rows: asWritten(range) });
  }
  return blocks;
}

/** Tables to a size, then all cells: one batch, unless there are very many cells. */
async function write(sheet, size, context) {
  const there = context.workbook.worksheets.getItem(sheet.name);
  const [first, ...rest] = portions(sheet.blocks);
  quietly(context);
  for (const at of sheet.cleared) there.getRange(at).clear("Contents");
  for (const table of sheet.tables) {
    if (table.before === table.after) continue;
    there.tables.getItem(table.name).resize(table[size]);
    if (size === "after" && table.added) there.getRange(table.added).copyFrom(table.first, "Formats");
  }
  for (const list of [first, ...rest]) {
    if (list !== first) quietly(context);
    for (const { at, rows } of list) there.getRange(at).formulas = rows;
    await context.sync();
  }
}

/** The cells of before, sheet by sheet. */
const earlier = (sheet, blocks) => ({ ...sheet, cleared: [], blocks });

/**
 * Fill the open workbook. What is cancelled, or fails, between two sheets puts back what it has written.
 *
 * @param results what the server says: sheets with tables and blocks
 * @param progress called with the share of the cells that is written, 0 to 1
 * @param isOver whether it is cancelled
 * @returns the sheets with the cells of before, for `putBack`
 */
export async function fill(results, progress = () => {}, isOver = () => false) {
  return Excel.run(async context => {
    await check(results.sheets, "before", context);
    const before = [];
    for (const sheet of results.sheets) {
      if (isOver()) throw cancelled();
      before.push(earlier(sheet, await cellsOf(sheet, context)));
    }
    let begun = 0, written = 0;
    try {
      for (const sheet of results.sheets) {
        if (isOver()) throw cancelled();
        begun += 1;
        await write(sheet, "after", context);
        written += sheet.blocks.reduce((sum, { rows }) => sum + rows.length * rows[0].length, 0);
        progress(written / results.cells);
      }
    } catch (failed) {
      await undo(before.slice(0, begun), failed);
      throw failed;
    }
    return before;
  });
}

/** Put back what a failed or cancelled run has written; where that fails, too, say so. */
async function undo(sheets, reason) {
  try {
    await Excel.run(async context => {
      for (const sheet of sheets) await write(sheet, "before", context);
    });
  } catch (failed) {
    const names = sheets.map(sheet => sheet.name).join(", ");
    throw wrong(`${reason.message} The earlier values could not be put back (${failed.message}): results on ${names} are incomplete. Recalculate.`);
  }
}

/** Write back what `fill` found. */
export async function putBack(sheets, progress = () => {}) {
  return Excel.run(async context => {
    await check(sheets, "after", context);
    for (const [i, sheet] of sheets.entries()) {
      await write(sheet, "before", context);
      progress((i + 1) / sheets.length);
    }
  });
}
