// A stand-in for the Office host: what functions.js and the page use of office.js, and no more.
// It plays Excel: calls functions, shows what streams set, says which cells are blank, hands the
// open workbook over in slices, and lets it be written as Excel would: it checks every call.
(() => {
  const functions = {};
  const stand = window.standIn = { functions, sheets: {}, reads: 0, failReads: false, workbook: null };

  window.CustomFunctions = {
    associate(id, body) { functions[id] = body; },
    Error: class extends Error {
      constructor(code, message) { super(message); this.code = code; }
    },
    ErrorCode: {
      invalidValue: "#VALUE!", notAvailable: "#N/A", divisionByZero: "#DIV/0!", invalidNumber: "#NUM!",
      nullReference: "#NULL!", invalidName: "#NAME?", invalidReference: "#REF!",
    },
  };

  const succeeded = value => ({ status: "succeeded", value });
  const file = () => {
    const size = 100000, bytes = stand.workbook;
    return {
      size: bytes.length,
      sliceCount: Math.ceil(bytes.length / size),
      getSliceAsync: (i, done) => setTimeout(() => done(succeeded({ data: Array.from(bytes.slice(i * size, (i + 1) * size)) })), 1),
      closeAsync: done => { stand.closed = true; done(succeeded()); },
    };
  };
  window.Office = {
    onReady(then) { const info = { host: "Excel", platform: "OfficeOnline" }; if (then) then(info); return Promise.resolve(info); },
    FileType: { Compressed: "compressed" },
    context: { document: {
      url: "https://example.com/shared/My%20train.xlsx",
      getFileAsync: (kind, options, done) => setTimeout(() => done(stand.workbook ? succeeded(file()) : { status: "failed", error: { message: "no file" } }), 1),
    } },
  };

  // --- Excel's own interface: every member that is used has to be in a requirement set of the manifest ---

  /** Requirement set of each member, after the declarations of @types/office-js 1.0.612: ExcelApi 1.x. */
  const SETS = {
    Context: { workbook: 1, application: 1, sync: 1 },
    Application: { suspendApiCalculationUntilNextSync: 6, suspendScreenUpdatingUntilNextSync: 9 },
    Workbook: { worksheets: 1 },
    WorksheetCollection: { getItem: 1, getItemOrNullObject: 4 },
    Worksheet: { getRange: 1, tables: 1, protection: 2, isNullObject: 4 },
    WorksheetProtection: { load: 1, protected: 2 },
    TableCollection: { getItem: 1, getItemOrNullObject: 4 },
    Table: { getRange: 1, resize: 13, isNullObject: 4 },
    Range: { load: 1, address: 1, values: 1, formulas: 1, valueTypes: 1, clear: 1, copyFrom: 9 },
  };
  /** What Excel on the web takes in one batch. [B] */
  const MOST = 5e6;
  /** Texts that Excel would make something else of. */
  const READ_OTHERWISE = /^\s*[=+\-@.\d]|^(true|false)$|\d\s*[-/:.]\s*\d/i;
  const ERRORS = /^#(N\/A|VALUE!|REF!|DIV\/0!|NUM!|NAME\?|NULL!)$/;
  const refused = message => new Error(message);

  stand.book = {};      // sheet → {cells: {"B7": [formula, value, type]}, tables: {name: address}, isProtected}
  stand.batches = [];   // of each sync that wrote: the sheets
  stand.refusals = [];  // calls that Excel would not take: none may happen
  stand.slow = 0;       // [ms] of each sync
  stand.fails = {};     // sheet → how many batches of it fail
  stand.allowed = fetch("/manifest.xml").then(said => said.text())
    .then(text => Number(/Name="ExcelApi" MinVersion="1\.(\d+)"/.exec(text)[1]));

  const number = letters => [...letters].reduce((sum, letter) => 26 * sum + letter.charCodeAt(0) - 64, 0);
  const letters = count => (count > 26 ? letters(Math.floor((count - 1) / 26)) : "") + String.fromCharCode(65 + (count - 1) % 26);
  function corners(address) {
    const found = /^([A-Z]+)(\d+)(?::([A-Z]+)(\d+))?$/.exec(address);
    if (!found) throw refused(`${address} is no address`);
    const [, left, top, right = left, bottom = top] = found;
    return { left: number(left), top: Number(top), right: number(right), bottom: Number(bottom) };
  }
  function cellsIn(address) {
    const { left, top, right, bottom } = corners(address);
    return Array.from({ length: bottom - top + 1 }, (_, i) => Array.from({ length: right - left + 1 }, (_, j) => letters(left + j) + (top + i)));
  }
  const meet = (a, b) => a.left <= b.right && b.left <= a.right && a.top <= b.bottom && b.top <= a.bottom;

  /** A cell after something was typed into it: formula, value, type. */
  function typed(content) {
    if (content === null || content === undefined) throw refused("null leaves a cell as it is, which is never meant here");
    if (content === "") return null;
    if (typeof content === "boolean") return [content, content, "Boolean"];
    if (typeof content === "number") {
      if (!Number.isFinite(content)) throw refused(`${content} is no number of a cell`);
      return [content, content, "Double"];
    }
    if (content.startsWith("'")) return content === "'" ? null : [content.slice(1), content.slice(1), "String"];
    if (ERRORS.test(content)) return [content, content, "Error"];
    if (content.startsWith("=")) return [content, 0, "Double"];
    if (READ_OTHERWISE.test(content)) throw refused(`Excel would not keep the text ${content}`);
    return [content, content, "String"];
  }

  /** An object of the host: members that are not in a requirement set of the manifest cannot be used. */
  function hosted(kind, object, allowed) {
    const member = name => {
      if (typeof name === "symbol" || name === "then") return true;
      const set = SETS[kind][name];
      if (set === undefined || set > allowed) {
        const why = set === undefined ? "is not known to the stand-in" : `needs ExcelApi 1.${set}; the manifest asks for 1.${allowed}`;
        stand.refusals.push(`${kind}.${name}`);
        throw refused(`${kind}.${name} ${why}`);
      }
      return true;
    };
    return new Proxy(object, {
      get: (it, name) => member(name) && it[name],
      set: (it, name, value) => { member(name); it[name] = value; return true; },
    });
  }

  window.Excel = {
    async run(body) {
      stand.reads += 1;
      if (stand.failReads) throw new Error("busy");
      const allowed = await stand.allowed, queue = [], isLoaded = new WeakMap();
      let wrote = new Set(), size = 0;
      const of = (kind, object) => hosted(kind, object, allowed);
      const loadable = (it, read) => {
        it.load = what => {
          if (typeof what !== "string") throw refused("load takes names");
          queue.push(() => what.split(",").forEach(name => { isLoaded.set(it, { ...isLoaded.get(it), [name.trim()]: read(name.trim()) }); }));
        };
        return name => {
          const found = isLoaded.get(it);
          if (!found || !(name in found)) throw refused(`${name} was not loaded and synchronized`);
          return found[name];
        };
      };
      const writing = (name, work) => queue.push(() => {
        const sheet = stand.book[name];
        if (!sheet) throw refused(`there is no sheet ${name}`);
        if (sheet.isProtected) throw refused(`AccessDenied: ${name} is protected`);
        if (stand.fails[name] > 0) { stand.fails[name] -= 1; throw refused("made up"); }
        wrote.add(name);
        work(sheet);
      });

      /** An object of which one asks whether it is there, after a sync. */
      function mayBeMissing(isThere) {
        const it = {};
        let found;
        queue.push(() => { found = isThere(); });
        Object.defineProperty(it, "isNullObject", { get() {
          if (found === undefined) throw refused("isNullObject was not synchronized");
          return !found;
        } });
        return it;
      }

      function range(name, address) {
        const it = {}, place = (stand.sheets[name] || {})[address];
        if (!place) corners(address);
        const value = loadable(it, what => {
          if (place) return place[what];
          const cells = stand.book[name].cells, at = cellsIn(address);
          if (what === "address") return `'${name.replaceAll("'", "''")}'!${address}`;
          const index = { formulas: 0, values: 1, valueTypes: 2 }[what];
          if (index === undefined) throw refused(`Range has no ${what} to load`);
          return at.map(row => row.map(cell => (cells[cell] ? cells[cell][index] : ["", "", "Empty"][index])));
        });
        for (const what of ["address", "values", "valueTypes"]) Object.defineProperty(it, what, { get: () => value(what) });
        Object.defineProperty(it, "formulas", {
          get: () => value("formulas"),
          set(rows) {
            const at = cellsIn(address);
            if (!Array.isArray(rows) || rows.length !== at.length || rows.some((row, i) => row.length !== at[i].length)) {
              throw refused(`the rows for ${address} have another shape than it`);
            }
            size += JSON.stringify(rows).length;
            writing(name, sheet => at.forEach((row, i) => row.forEach((cell, j) => {
              const content = typed(rows[i][j]);
              if (content) sheet.cells[cell] = content; else delete sheet.cells[cell];
            })));
          },
        });
        it.clear = what => {
          if (what !== "Contents") throw refused("formats of the engineer would be cleared");
          writing(name, sheet => cellsIn(address).flat().forEach(cell => delete sheet.cells[cell]));
        };
        it.copyFrom = (source, what) => {
          if (what !== "Formats") throw refused("more than formats would be copied");
          corners(source);
          writing(name, sheet => (sheet.formatted ||= []).push(address));
        };
        return of("Range", it);
      }

      function table(name, title, orNull) {
        const it = orNull ? mayBeMissing(() => title in stand.book[name].tables) : {};
        it.getRange = () => range(name, stand.book[name].tables[title]);
        it.resize = address => writing(name, sheet => {
          const old = corners(sheet.tables[title]), now = corners(address);
          if (old.top !== now.top || !meet(old, now) || now.bottom === now.top) throw refused(`${title} cannot become ${address}`);
          for (const [other, there] of Object.entries(sheet.tables)) {
            if (other !== title && meet(now, corners(there))) throw refused(`${title} would meet ${other}`);
          }
          sheet.tables[title] = address;
        });
        return of("Table", it);
      }

      function worksheet(name, orNull) {
        const it = orNull ? mayBeMissing(() => name in stand.book) : {};
        it.getRange = address => range(name, address);
        it.tables = of("TableCollection", { getItem: title => table(name, title), getItemOrNullObject: title => table(name, title, true) });
        const protection = {}, value = loadable(protection, () => Boolean(stand.book[name].isProtected));
        Object.defineProperty(protection, "protected", { get: () => value("protected") });
        it.protection = of("WorksheetProtection", protection);
        return of("Worksheet", it);
      }

      const context = of("Context", {
        workbook: of("Workbook", { worksheets: of("WorksheetCollection", {
          getItem: name => worksheet(name), getItemOrNullObject: name => worksheet(name, true),
        }) }),
        application: of("Application", { suspendApiCalculationUntilNextSync() {}, suspendScreenUpdatingUntilNextSync() {} }),
        async sync() {
          if (stand.slow) await new Promise(done => setTimeout(done, stand.slow));
          if (size > MOST) throw refused("RequestPayloadSizeLimitExceeded");
          try { for (const act of queue.splice(0)) act(); } finally {
            queue.length = 0;
            if (wrote.size) stand.batches.push([...wrote]);
            wrote = new Set();
            size = 0;
          }
        },
      });
      const result = await body(context);
      await context.sync();
      return result;
    },
  };

  const KINDS = { number: "Double", string: "String", boolean: "Boolean" };
  let placed = 0;

  /** Tables stand on a sheet, and their blank cells are handed over as 0; the rest was typed into the formula. */
  function onSheet(given) {
    const addresses = given.map(value => {
      if (!Array.isArray(value) || !Array.isArray(value[0])) return "";
      const sheet = stand.sheets.Tables ||= {}, place = `T${placed += 1}`;
      sheet[place] = {
        values: value.map(row => row.map(cell => cell ?? "")),
        valueTypes: value.map(row => row.map(cell => (cell === null ? "Empty" : KINDS[typeof cell] || "Error"))),
      };
      return `Tables!${place}`;
    });
    const handed = given.map((value, i) => (addresses[i] ? value.map(row => row.map(cell => cell ?? 0)) : value));
    return { addresses, handed };
  }

  const seen = failed => ({ error: failed.code || failed.name, message: failed.message });

  /** One cell with a function; a streaming one ends with its first answer that is no stage. */
  stand.cell = (id, given, more = {}) => new Promise(resolve => {
    const shown = [];
    const { addresses, handed } = "addresses" in more ? { addresses: more.addresses ?? undefined, handed: given } : onSheet(given);
    const invocation = {
      parameterAddresses: addresses,
      setResult(value) {
        if (value instanceof Error) resolve({ ...seen(value), shown });
        else if (String(value[0][0]).startsWith("…")) shown.push(value[0][0]);
        else resolve({ value, shown });
      },
    };
    if (more.cancelAfter) {
      setTimeout(() => { invocation.onCanceled(); setTimeout(() => resolve({ cancelled: true, shown }), 300); }, more.cancelAfter);
    }
    try {
      Promise.resolve(functions[id](...handed, invocation)).then(
        value => { if (value !== undefined) resolve({ value }); },
        failed => resolve(seen(failed)),
      );
    } catch (failed) { resolve(seen(failed)); }
  });
})();
