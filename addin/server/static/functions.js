// The functions of the cells, and the connection to the server that the page uses as well.
//
// Excel asks for each cell by itself. Calls of the same moment are collected into one request; what
// may have to calculate a start goes over one WebSocket, so that the cell shows how far it is.
(() => {
  "use strict";

  /** Id in the Office host, name of the function, whether it may calculate a start. */
  const FUNCTIONS = "the functions";
  /** How long calls are collected, how many one request carries, and how many requests go at a time. [ms, count] */
  const COLLECT = 5, MOST_CALLS = 1000, REQUESTS = 2;
  /** Long calls that the server has at a time: half as many as it lets wait. [count] */
  const LONG_CALLS = 32;
  /** Arguments of models that are kept. [characters] */
  const KEPT = 60e6;
  /** Whoever cancels one cell may cancel the next as well: its place stays empty for so long. [ms] */
  const LINGER = 200;
  /** A cell shows stages only of what takes longer than this. [ms] */
  const PATIENCE = 800;
  /** How often a busy server is asked for a cell, one that is not there, and any for the page; pauses at first and at most. [count, ms] */
  const TRIES = 20, LOST_TRIES = 5, PAGE_TRIES = 4, PAUSE = 1000, LONGEST_PAUSE = 30000;

  const wrong = (message, code = "#N/A") => ({ message, code });
  const lost = message => ({ ...wrong(message), lost: true });
  const cancelled = () => ({ ...wrong("Cancelled."), cancelled: true });

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

  /** Wait before a busy server is asked again: twice as long each time, and not all cells at once. */
  function pause(tried) {
    const longest = Math.min(PAUSE * 2 ** (tried - 1), LONGEST_PAUSE);
    return new Promise(done => setTimeout(done, longest * (0.5 + 0.5 * Math.random())));
  }

  /** A cell asks again: a busy server often, one that is gone a few times, one that has forgotten the model once it has it again. */
  async function patiently(attempt, asked, isOver = () => false, waiting = () => {}) {
    let isSentAgain = false;
    for (let tried = 1; ; tried += 1) {
      try {
        return await attempt();
      } catch (failed) {
        if (isOver()) throw failed;
        if (failed.forgotten && !isSentAgain && await sendAgain(asked)) {
          isSentAgain = true;
          continue;
        }
        if (tried >= (failed.busy ? TRIES : failed.lost ? LOST_TRIES : 0)) throw failed;
        waiting(failed.busy ? "the server is busy" : "waiting for the server");
        await pause(tried);
      }
    }
  }

  /** Ask the server; its refusals come as errors with its own sentence. */
  async function ask(path, options, tries = PAGE_TRIES) {
    for (let tried = 1; ; tried += 1) {
      let response;
      try {
        response = await fetch(path, { method: "POST", ...options, headers: headers(options.headers) });
      } catch (failed) {
        if (failed.name === "AbortError") throw failed;
        throw lost("The calculation server cannot be reached. Is it running, and its certificate trusted?");
      }
      if (response.ok) return response;
      if (response.status === 503 && tried < tries) {
        await pause(tried);
        continue;
      }
      let content = {};
      try { content = await response.json(); } catch { /* not from our server: a proxy, perhaps */ }
      const message = (content.error || {}).message || `The server answered with status ${response.status}. Try again, or ask its administrator.`;
      throw Object.assign(wrong(message), { status: response.status, content });
    }
  }

  /** Collects what is asked for in a moment and has it done together: so much at once, in so many pieces at a time. */
  function together(work, most = Infinity, pieces = Infinity) {
    const waiting = [];
    let timer = null, going = 0;
    const begin = () => {
      timer = null;
      while (waiting.length && going < pieces) {
        const taken = waiting.splice(0, most);
        going += 1;
        work(taken).catch(failed => taken.forEach(request => request.reject(failed.message ? failed : wrong(String(failed)))))
          .finally(() => { going -= 1; begin(); });
      }
    };
    return asked => new Promise((resolve, reject) => {
      waiting.push({ asked, resolve, reject });
      if (timer === null && going < pieces) timer = setTimeout(begin, COLLECT);
    });
  }

  /** Cells that ask for the same share one answer; what nobody waits for any more is given up. */
  function shared(begin) {
    const going = new Map();
    return (asked, stage = () => {}) => {
      const name = JSON.stringify(asked);
      let one = going.get(name);
      if (!one) {
        one = { stages: new Set(), last: "" };
        going.set(name, one);
        one.work = begin(asked, text => { one.last = text; one.stages.forEach(tell => tell(text)); });
        const over = () => { if (going.get(name) === one) going.delete(name); };
        one.work.done.then(over, over);
      }
      const tell = text => stage(text);
      one.stages.add(tell);
      if (one.last) tell(one.last);
      return {
        done: one.work.done,
        cancel() {
          if (!one.stages.delete(tell) || one.stages.size) return;
          if (going.get(name) === one) going.delete(name);
          one.work.cancel();
        },
      };
    };
  }

  // --- short calls: one request for many cells -----------------------------------------------------

  const send = together(async taken => {
    const calls = taken.map(request => request.asked);
    const response = await ask("/api/v1/batch", {
      body: JSON.stringify({ calls }), headers: { "Content-Type": "application/json" },
    }, TRIES);
    const { results } = await response.json();
    taken.forEach((request, i) => {
      if (results[i].error) request.reject(results[i].error); else request.resolve(results[i].value);
    });
  }, MOST_CALLS, REQUESTS);

  /** A call that is answered at once. */
  const short = shared(asked => ({
    done: patiently(() => send(asked), asked).then(value => keep(asked, value)),
    cancel() {},
  }));

  const call = (name, given) => short({ name, arguments: given }).done;

  // --- models: what made each handle, in case the server forgets it --------------------------------

  const MODEL = "TV_MODEL";
  /** Handles with the arguments that made them, as text; the last used last. */
  const models = new Map();
  let kept = 0;

  /** Keep what made a handle: as many characters as `KEPT`. */
  function keep({ name, arguments: given }, value) {
    if (name !== MODEL) return value;
    const handle = value[0][0], text = JSON.stringify(given);
    forget(handle);
    models.set(handle, text);
    kept += text.length;
    while (kept > KEPT) forget(models.keys().next().value);
    return value;
  }

  function forget(handle) {
    kept -= (models.get(handle) || "").length;
    models.delete(handle);
  }

  /** Send the model of a call again to a server that was started anew; whether it has it now. */
  async function sendAgain({ arguments: given }) {
    const handles = given.map(value => rowsOf(value)[0]).flat().filter(value => models.has(value));
    for (const handle of handles) await call(MODEL, JSON.parse(models.get(handle)));
    return handles.length > 0;
  }

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
        const why = refusal || lost("The connection to the calculation server was lost. Calculate again.");
        socket = opening = refusal = null;
        reject(why);
        for (const request of running.values()) request.reject(why);
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
    if (message.cancelled) request.reject(cancelled());
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

  /** Long calls of cells that wait for one of the places at the server. */
  const queue = [];
  let places = LONG_CALLS;

  function next() {
    while (places && queue.length) {
      places -= 1;
      queue.shift()().then(isOver => setTimeout(() => { places += 1; next(); }, isOver ? LINGER : 0));
    }
  }

  /** Do something once there is a place, unless it is over before; what is over later leaves its place empty for a while. */
  function inTurn(work, isOver) {
    return new Promise((resolve, reject) => {
      queue.push(async () => {
        if (isOver()) { reject(cancelled()); return false; }
        try { resolve(await work()); } catch (failed) { reject(failed); }
        return isOver();
      });
      next();
    });
  }

  /** A long call of a cell. */
  const long = shared((asked, stage) => {
    let over = false, begun = null, giveUp;
    const isOver = () => over;
    const attempt = () => inTurn(() => { begun = stream(asked, { stage }); return begun.done; }, isOver);
    const done = new Promise((resolve, reject) => {
      giveUp = () => reject(cancelled());
      patiently(attempt, asked, isOver, stage).then(resolve, reject);
    });
    const cancel = () => { over = true; if (begun) begun.cancel(); giveUp(); };
    return { done, cancel };
  });

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

  const UNKNOWN = "Excel does not tell here which cells are blank and which are 0";
  const DIRECTLY = "give the cells of the sheet themselves, not what a formula makes of them";

  /** Excel may hand over a blank cell as 0: the sheet itself is asked. Where it does not say, there is no answer. */
  async function withBlanks(given, addresses) {
    const doubtful = given.map(holdsZero);
    if (!doubtful.includes(true)) return given;
    const known = Array.isArray(addresses);
    const asked = given.map((value, i) => {
      if (!doubtful[i]) return null;
      const address = known && addresses[i];
      // a single number without an address was typed into the formula, where addresses are given at all
      if (!address && (!known || isTable(value))) {
        throw wrong(`Argument ${i + 1} contains a 0, and ${UNKNOWN}: ${DIRECTLY}, or type a small number in place of a 0 that is meant.`);
      }
      return address || null;
    });
    const found = await Promise.all(asked.map(address => (address ? cellsAt(address) : null)));
    return given.map((value, i) => {
      if (!found[i]) return value;
      const rows = rowsOf(value), { valueTypes: kinds, values } = found[i];
      const differs = kinds.length !== rows.length || rows.some((row, r) => kinds[r].length !== row.length
        || row.some((cell, c) => !isSame(cell, kinds[r][c], values[r][c])));
      if (differs) {
        throw wrong(`Argument ${i + 1} is not what ${asked[i]} contains: Excel may be calculating. Calculate again; if it stays, ${DIRECTLY}.`);
      }
      return rows.map((row, r) => row.map((cell, c) => (kinds[r][c] === "Empty" ? null : cell)));
    });
  }

  const isTable = value => Array.isArray(value) && (value.length > 1 || rowsOf(value[0]).flat().length > 1);

  /** Whether a value handed over can be that of a cell of the sheet. */
  function isSame(cell, kind, value) {
    if (kind === undefined) return false;
    if (kind === "Empty") return cell === 0 || cell === null || cell === "" || cell === undefined;
    return typeof cell !== "number" || cell === value;
  }

  /** What each cell of a range holds, and of which kind; the ranges of a moment are read together, each once. */
  const cellsAt = together(async taken => {
    try {
      await Excel.run(async context => {
        const ranges = new Map();
        for (const { asked: address } of taken) {
          if (ranges.has(address)) continue;
          const cut = address.lastIndexOf("!");
          const sheet = address.slice(0, cut).replace(/^'|'$/g, "").replace(/''/g, "'");
          const range = context.workbook.worksheets.getItem(sheet).getRange(address.slice(cut + 1));
          range.load("valueTypes, values");
          ranges.set(address, range);
        }
        await context.sync();
        taken.forEach(request => request.resolve(ranges.get(request.asked)));
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
      begun = long({ name, arguments: sent }, tell);
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
