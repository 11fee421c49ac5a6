// What a study of the open file reads beside the train, as forms: its tables and its settings.
import { drawnTable, inputsAddress } from "./inputs.js";
import { ask, at, made } from "./page.js";

/** Settings that are not the usual ones, by study. */
export const settings = { of: {}, changed() {} };

/** Tables and settings of a study of a file. */
export async function showStudy(study, name, bytes, host) {
  const response = await ask(inputsAddress("inputs", name, study), { body: bytes });
  const content = await response.json();
  at("study-tables").replaceChildren(...content.tables.map(one => drawnTable(one, host)));
  at("study-settings").replaceChildren(...content.settings.map(one => setting(study, one, host)));
  at("study-note").hidden = content.tables.length + content.settings.length > 0;
}

/** A setting, kept unless it is the usual one; its words are those of the command line. */
function setting(study, { name, help, default: usual, words, least, most }, { refuse }) {
  const own = settings.of[study] || {}, line = made("div", null, "setting"), label = made("label", name), isFlag = typeof usual === "boolean";
  const input = made(words.length ? "select" : "input");
  if (words.length) input.append(...words.map(word => Object.assign(made("option", word), { value: word })));
  else input.type = isFlag ? "checkbox" : "text";
  const value = name in own ? own[name] : usual;
  if (isFlag) input.checked = value; else input.value = String(value);
  input.addEventListener("change", () => {
    const typed = isFlag ? input.checked : words.length ? input.value : Number(input.value.trim() || NaN);
    const wrong = typeof typed === "number" && (!Number.isInteger(typed) || typed < least || (most !== null && typed > most));
    input.setAttribute("aria-invalid", String(wrong));
    const kept = { ...settings.of[study] };
    delete kept[name];
    if (wrong) refuse(`${name} must be a whole number, ${least} or more${most === null ? "" : `, ${most.toLocaleString("en-US")} at most`}.`);
    else if (typed !== usual) kept[name] = typed;
    settings.of[study] = kept;
    settings.changed();
  });
  const hint = made("span", help.replace(/`/g, ""), "hint");
  input.id = label.htmlFor = `setting-${name}`;
  hint.id = `about-${name}`;
  input.setAttribute("aria-describedby", hint.id);
  line.append(label, input, hint);
  return line;
}
