// A stand-in for the Office host: what functions.js and the page use of office.js, and no more.
// It plays Excel: calls functions, shows what streams set, says which cells are blank, hands the
// open workbook over in slices.
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

  window.Excel = {
    async run(body) {
      stand.reads += 1;
      if (stand.failReads) throw new Error("busy");
      const asked = [];
      await body({
        workbook: { worksheets: { getItem: sheet => ({ getRange: place => {
          const range = { load(what) { asked.push([range, sheet, place, what]); } };
          return range;
        } }) } },
        async sync() { for (const [range, sheet, place, what] of asked) for (const one of what.split(", ")) range[one] = stand.sheets[sheet][place][one]; },
      });
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
