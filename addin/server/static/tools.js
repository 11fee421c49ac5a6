// What is made of the open file beside its results: report, verification, comparison, studies.
import { lastLine } from "./lines.js";
import { ask, at, made, table } from "./page.js";
import { settings } from "./study_forms.js";

/** Buttons of the tools, with what they ask for. */
export function setUp(current, during) {
  for (const button of document.querySelectorAll("[data-task]")) {
    button.addEventListener("click", () => {
      const { task, form } = button.dataset, { name, bytes } = current();
      const study = task === "study" ? at("study").value : undefined, own = settings.of[study];
      const query = { form, study, settings: own && JSON.stringify(own) };
      during(signal => documentOf(task, query, name, bytes, signal));
    });
  }
  at("compare-opened").addEventListener("click", () => compare(current().original, current, during));
  at("earlier").addEventListener("change", async event => {
    const [file] = event.target.files;
    if (file) await compare(await file.arrayBuffer(), current, during);
    event.target.value = "";
  });
}

function compare(earlier, current, during) {
  const { name, bytes } = current(), both = new Blob([earlier, bytes]);
  return during(signal => documentOf("diff", { split: earlier.byteLength }, name, both, signal));
}

/** Ask for a document and show it; gives the words to say at the end. */
async function documentOf(task, query, name, body, { signal, stage }) {
  const words = new URLSearchParams({ name });
  for (const [key, value] of Object.entries(query)) if (value !== undefined) words.set(key, value);
  at("document").replaceChildren();
  const response = await ask(`/api/v1/${task}?${words}`, { body, signal });
  const { value, warnings } = await lastLine(response, stage);
  const blocks = value.blocks.flatMap(({ text, below, title, rows }, k) => (rows ? tableOf(title, rows, k) : [made("p", text, below ? "hint below" : "")]));
  const files = value.files.map(file => linkTo(file, `${name.replace(/\.[^.]*$/, "")}${query.study ? `.${query.study}` : ""}${file.ending}`));
  const notes = warnings.map(text => made("p", `Note: ${text}`, "hint"));
  at("document").replaceChildren(...files, ...blocks, ...notes);
  if (task === "report") files[0].querySelector("a").click();
  else at("document").focus();
  return { report: "The report is in your downloads.", verify: "Verified; see below.", diff: "Compared; see below.", study: "The study is done; see below." }[task];
}

function tableOf(title, rows, place) {
  const drawn = made("div", null, "scroll");
  drawn.tabIndex = 0;
  drawn.setAttribute("role", "region");
  drawn.setAttribute("aria-label", title || `Table of the study, part ${place + 1}`);
  drawn.append(table(rows, ""));
  // on a narrow page each cell stands below the one before, with the header before it
  const heads = [...drawn.querySelectorAll("th")].map(one => one.textContent);
  for (const row of drawn.querySelectorAll("tbody tr")) [...row.cells].forEach((cell, j) => { cell.dataset.head = heads[j]; });
  return title ? [made("h3", title), drawn] : [drawn];
}

/** A file from the server to be downloaded. */
function linkTo({ media, content }, name) {
  const bytes = Uint8Array.from(atob(content), letter => letter.charCodeAt(0));
  const link = made("a", name), line = made("p", "File: ");
  link.href = URL.createObjectURL(new Blob([bytes], { type: media }));
  link.download = name;
  line.append(link);
  return line;
}
