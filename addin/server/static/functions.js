// The functions of the cells, and the connection to the server that the page uses as well.
//
// Excel asks for each cell by itself. Calls of the same moment are collected into one request; what
// may have to calculate a start goes over one WebSocket, so that the cell shows how far it is.
(() => {
  "use strict";

  /** Id in the Office host, name of the function, whether it may calculate a start. */
  const FUNCTIONS = "the functions";
  /** How long calls are collected, and how many one request carries. [ms, count] */
  const COLLECT = 5, MOST_CALLS = 1000;
  /** A cell shows stages only of what takes longer than this. [ms] */
  const PATIENCE = 800;
  /** How often, and after how long, a busy server is asked again. [count, ms] */
  const TRIES = 4, PAUSE = 1000;

  const wrong = (message, code = "#N/A") => ({ message, code });

  // --- the server ---------------------------------------------------------------------------------

  const KEY = "torsionbook.key";

  function key() {
    try { return localStorage.getItem(KEY) || ""; } catch { return ""; }
  }

  function setKey(text) {
    try { localStorage.setItem(KEY, text.trim()); } catch { /* it is asked for again next time */ }
    if (socket) socket.close();
  }

  function headers(more) {
    return key() ? { ...more, "X-API-Key": key() } : more;
  }

  /** Ask the server; its refusals come as errors with its own sentence. */
  async function ask(path, options) {
    for (let tried = 1; ; tried += 1) {
      let response;
      try {
        response = await fetch(path, { method: "POST", ...options, headers: headers(options.headers) });
      } catch (failed) {
        if (failed.name === "AbortError") throw failed;
        throw wrong("The calculation server cannot be reached. Is it running, and its certificate trusted?");
      }
      if (response.ok) return response;
      if (response.status === 503 && tried < TRIES) {
        await new Promise(done => setTimeout(done, PAUSE * tried));
        continue;
      }
      let content = {};
      try { content = await response.json(); } catch { /* not from our server: a proxy, perhaps */ }
      const message = (content.error || {}).message || `The server answered with status ${response.status}. Try again, or ask its administrator.`;
      throw Object.assign(wrong(message), { status: response.status, content });
    }
  }

  /** Collects what is asked for in a moment and has it done together; at most so many at a time. */
  function together(work, most = Infinity) {
    const waiting = [];
    let timer = null;
    const begin = () => {
      const taken = waiting.splice(0, most);
      timer = waiting.length ? setTimeout(begin, 0) : null;
      work(taken).catch(failed => taken.forEach(request => request.reject(failed.message ? failed : wrong(String(failed)))));
    };
    return asked => new Promise((resolve, reject) => {
      waiting.push({ asked, resolve, reject });
      if (timer === null) timer = setTimeout(begin, COLLECT);
    });
  }

  // --- short calls: one request for many cells -----------------------------------------------------

  const send = together(async taken => {
    const calls = taken.map(request => request.asked);
    const response = await ask("/api/v1/batch", {
      body: JSON.stringify({ calls }), headers: { "Content-Type": "application/json" },
    });
    const { results } = await response.json();
    taken.forEach((request, i) => {
      if (results[i].error) request.reject(results[i].error); else request.resolve(results[i].value);
    });
  }, MOST_CALLS);

  const call = (name, given) => send({ name, arguments: given });

  // --- long calls: one WebSocket -------------------------------------------------------------------

  let socket = null, opening = null, count = 0;
  const running = new Map();

  function connect() {
    if (opening) return opening;
    opening = new Promise((resolve, reject) => {
      socket = new WebSocket(location.origin.replace(/^http/, "ws") + "/api/v1/stream");
      socket.onopen = () => {
        if (key()) socket.send(JSON.stringify({ key: key() }));
        resolve(socket);
      };
      socket.onmessage = event => receive(JSON.parse(event.data));
      socket.onclose = () => {
        const lost = refusal || wrong("The connection to the calculation server was lost. Calculate again.");
        socket = opening = refusal = null;
        reject(lost);
        for (const request of running.values()) request.reject(lost);
        running.clear();
      };
    });
    return opening;
  }

  let refusal = null;

  function receive(message) {
    const request = running.get(message.id);
    if (!request) {
      if (message.id === null && message.error) refusal = message.error;
      return;
    }
    if ("stage" in message) { request.stage(message.stage); return; }
    if ("partial" in message) { request.partial(message.partial); return; }
    running.delete(message.id);
    if (message.cancelled) request.reject(Object.assign(wrong("Cancelled."), { cancelled: true }));
    else if (message.error) request.reject(message.error);
    else request.resolve(message.value);
  }

  /** Ask for something long. Gives the promise of its end and a way to give it up. */
  function stream(request, { stage = () => {}, partial = () => {} } = {}) {
    const id = count += 1;
    let given_up = false;
    const done = new Promise((resolve, reject) => {
      running.set(id, { resolve, reject, stage, partial });
      connect().then(
        open => { if (!given_up) open.send(JSON.stringify({ ...request, id })); },
        failed => { running.delete(id); reject(failed); },
      );
    });
    const cancel = () => {
      given_up = true;
      if (!running.has(id)) return;
      if (socket && socket.readyState === WebSocket.OPEN) socket.send(JSON.stringify({ id, cancel: true }));
      // whoever asked does not wait for the server to say so
      receive({ id, cancelled: true });
    };
    return { done, cancel };
  }

  // --- cells ---------------------------------------------------------------------------------------

  const CODES = {
    "#VALUE!": "invalidValue", "#N/A": "notAvailable", "#NUM!": "invalidNumber",
    "#DIV/0!": "divisionByZero", "#NULL!": "nullReference", "#NAME?": "invalidName",
    "#REF!": "invalidReference",
  };

  function cellError({ message, code }) {
    const codes = CustomFunctions.ErrorCode;
    return new CustomFunctions.Error(codes[CODES[code]] || codes.invalidValue, message);
  }

  /** A blank of an answer is shown as a blank, not as 0. */
  const cells = rows => rows.map(row => row.map(value => (value === null ? "" : value)));

  const rowsOf = value => (Array.isArray(value) ? value : [[value]]);
  const holdsZero = value => rowsOf(value).some(row => [].concat(row).some(cell => cell === 0));

  /** Excel may hand over a blank cell as 0. Where that is possible the sheet itself is asked. */
  async function withBlanks(given, addresses) {
    const asked = given.map((value, i) => (holdsZero(value) ? (addresses || [])[i] : null));
    if (!asked.some(Boolean)) return given;
    const types = await Promise.all(asked.map(address => (address ? typesAt(address) : null)));
    return given.map((value, i) => {
      const kinds = types[i], rows = rowsOf(value);
      if (!kinds || kinds.length !== rows.length) return value;
      return rows.map((row, r) => row.map((cell, c) => (kinds[r][c] === "Empty" ? null : cell)));
    });
  }

  /** What kind of value each cell of a range holds; the ranges of a moment are read together. */
  const typesAt = together(async taken => {
    try {
      await Excel.run(async context => {
        const ranges = taken.map(({ asked: address }) => {
          const cut = address.lastIndexOf("!");
          const sheet = address.slice(0, cut).replace(/^'|'$/g, "").replace(/''/g, "'");
          const range = context.workbook.worksheets.getItem(sheet).getRange(address.slice(cut + 1));
          range.load("valueTypes");
          return range;
        });
        await context.sync();
        taken.forEach((request, i) => request.resolve(ranges[i].valueTypes));
      });
    } catch {
      throw wrong("Excel did not report which cells are blank and which are 0. Calculate again.");
    }
  });

  async function shortCell(name, given, invocation) {
    try {
      return cells(await call(name, await withBlanks(given, invocation.parameterAddresses)));
    } catch (failed) {
      throw cellError(failed);
    }
  }

  async function longCell(name, given, invocation) {
    let begun = null, over = false, stage = "";
    invocation.onCanceled = () => { over = true; if (begun) begun.cancel(); };
    const show = setTimeout(() => { if (!over && stage) invocation.setResult([[`… ${stage}`]]); stage = null; }, PATIENCE);
    const tell = text => {
      if (stage !== null) stage = text; else if (!over) invocation.setResult([[`… ${text}`]]);
    };
    try {
      const sent = await withBlanks(given, invocation.parameterAddresses);
      if (over) return;
      begun = stream({ name, arguments: sent }, { stage: tell });
      const value = await begun.done;
      if (!over) { over = true; invocation.setResult(cells(value)); }
    } catch (failed) {
      if (!over) { over = true; invocation.setResult(cellError(failed)); }
    } finally {
      clearTimeout(show);
    }
  }

  function associate() {
    for (const [id, name, isLong] of FUNCTIONS) {
      CustomFunctions.associate(id, (...given) => {
        const invocation = given.pop();
        const sent = given.map(value => (value === undefined ? null : value));
        return (isLong ? longCell : shortCell)(name, sent, invocation);
      });
    }
  }

  window.torsionbook = { ask, call, stream, key, setKey };
  if (window.CustomFunctions) associate();
  else if (window.Office) Office.onReady(() => { if (window.CustomFunctions) associate(); });
})();
