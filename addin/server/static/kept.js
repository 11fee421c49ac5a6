// What is open stays over a reload, in this browser alone: the file, the file as opened, and what is chosen.

/** Files that are kept, one a window. [count] */
const MOST = 4;
const STORE = "open";

/** The name of this window, the same after a reload. */
function own() {
  try {
    const id = sessionStorage.getItem("torsionbook.window") || crypto.getRandomValues(new Uint32Array(2)).join("-");
    sessionStorage.setItem("torsionbook.window", id);
    return id;
  } catch { return null; }
}

const wait = request => new Promise((resolve, reject) => {
  request.onsuccess = () => resolve(request.result);
  request.onerror = () => reject(request.error);
});

async function store(mode, work) {
  const id = own();
  if (!id || !window.indexedDB) return null;
  try {
    const opening = indexedDB.open("torsionbook", 1);
    opening.onupgradeneeded = () => opening.result.createObjectStore(STORE, { keyPath: "id" });
    const base = await wait(opening);
    try { return await work(base.transaction(STORE, mode).objectStore(STORE), id); } finally { base.close(); }
  } catch { return null; } // a browser that keeps nothing: the page works without
}

/** Keep what is open. */
export const remember = state => store("readwrite", async (files, id) => {
  await wait(files.put({ ...state, id, at: Date.now() }));
  const all = await wait(files.getAll());
  for (const old of all.sort((a, b) => b.at - a.at).slice(MOST)) await wait(files.delete(old.id));
});

/** What was open before the reload; null where nothing was. */
export const recall = () => store("readonly", async (files, id) => (await wait(files.get(id))) || null);

export const forget = () => store("readwrite", (files, id) => wait(files.delete(id)));
