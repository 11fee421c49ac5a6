// A mode shape, drawn along the train and moved: one curve of physical twist, discs that rock with it.
import { element } from "./charts.js";
import { at, made, number } from "./page.js";

/** Size of the picture, room for a name, and how far a disc rocks at most. [px, px, degrees] */
const HEIGHT = 300, MIDDLE = 120, SWING = 90, ROCK = 35, DISC = 232;
/** Cycles a second as shown, whatever the frequency of the mode. [Hz] */
const SHOWN = 0.5;

let frame = 0;
/** Mode that was looked at last. */
let last = "";

/** Stations in the order of the train; null where a branch begins. Elements are left out. */
function orderOf(items, stations) {
  const places = items.map(name => (name === null ? null : stations.get(name))).filter(place => place !== undefined);
  return places.filter((place, i) => place !== null || (i > 0 && places[i - 1] !== null));
}

/** Mode shapes to choose from, and the one that is chosen. */
export function showMotion(rows, items, frequencies) {
  cancelAnimationFrame(frame);
  at("motion").replaceChildren();
  if (rows.length < 2) return;
  const [head, ...body] = rows, modes = head.slice(1);
  const stations = new Map(body.map(([name], row) => [name, row]));
  const order = orderOf(items, stations);
  const hertz = frequencies.length ? frequencies[0].findIndex(name => /^Frequency/.test(name)) : -1, mode = frequencies.length ? frequencies[0].indexOf("Mode") : -1;
  const frequencyOf = name => { const row = frequencies.slice(1).find(one => `Mode ${one[mode]}` === name); return row ? row[hertz] : null; };
  const label = made("label", "Mode "), choice = made("select"), play = made("button", "Move"), words = made("span", null, "hint"), row = made("div", null, "row noprint");
  label.htmlFor = choice.id = "motion-mode";
  choice.append(...modes.map((name, j) => Object.assign(made("option", frequencyOf(name) === null ? name : `${name}: ${number(frequencyOf(name))} Hz`), { value: name, selected: last ? name === last : frequencyOf(name) > 0 && !modes.slice(0, j).some(other => frequencyOf(other) > 0) })));
  play.type = "button";
  play.setAttribute("aria-pressed", "false");
  row.append(label, choice, play, words);
  const room = made("div", null, "scroll");
  room.id = "mode-shape";
  room.tabIndex = 0;
  room.setAttribute("role", "region");
  room.setAttribute("aria-label", "Mode shape");
  at("motion").append(row, room);
  let picture = null;
  const draw = () => {
    last = choice.value;
    const j = head.indexOf(last);
    picture = pictureOf(order.map(place => (place === null ? null : { name: body[place][0], twist: body[place][j] })), choice.selectedOptions[0].textContent);
    room.replaceChildren(picture.svg);
    picture.move(1);
  };
  choice.addEventListener("change", draw);
  play.addEventListener("click", () => {
    const isOn = play.getAttribute("aria-pressed") !== "true";
    play.setAttribute("aria-pressed", String(isOn));
    play.textContent = isOn ? "Stop" : "Move";
    words.textContent = isOn ? `slowed to ${SHOWN} Hz` : "";
    cancelAnimationFrame(frame);
    if (!isOn) { picture.move(1); return; }
    const began = performance.now();
    const step = now => { picture.move(Math.cos(2 * Math.PI * SHOWN * (now - began) / 1000)); frame = requestAnimationFrame(step); };
    frame = requestAnimationFrame(step);
  });
  draw();
}

/** The picture of one mode; `move` shows it at a share of its largest twist. */
function pictureOf(stations, name) {
  const width = Math.max(560, 90 + 58 * stations.length), step = (width - 110) / Math.max(1, stations.length - 1);
  const svg = element("svg", { viewBox: `0 0 ${width} ${HEIGHT}`, role: "img", class: "motion", width, "aria-label": `${name}: ${stations.filter(Boolean).map(one => `${one.name} ${one.twist.toFixed(2)}`).join(", ")}` });
  const toX = i => 60 + step * i, toY = twist => MIDDLE - SWING * twist;
  for (const twist of [-1, 0, 1]) {
    svg.append(element("line", { x1: 46, x2: width - 36, y1: toY(twist), y2: toY(twist), class: twist ? "grid" : "zero" }));
    svg.append(element("text", { x: 40, y: toY(twist) + 4, class: "tick end" }, String(twist)));
  }
  svg.append(element("text", { transform: `translate(13 ${MIDDLE}) rotate(-90)`, class: "axis middle" }, "Relative twist"));
  const trace = share => stations.map((one, i) => (one ? `${i && stations[i - 1] ? "L" : "M"}${toX(i).toFixed(1)} ${toY(share * one.twist).toFixed(1)}` : "")).join("");
  for (const share of [1, -1]) svg.append(element("path", { d: trace(share), class: "envelope" }));
  const curve = svg.appendChild(element("path", { class: "line ink-navy", "stroke-width": 2 }));
  const discs = stations.map((one, i) => {
    if (!one) return null;
    const spoke = element("line", { x1: toX(i), x2: toX(i), y1: DISC, y2: DISC - 13, class: "spoke ink-rust" });
    const dot = element("circle", { r: 3.4, cx: toX(i), class: "spot ink-navy" });
    svg.append(element("circle", { cx: toX(i), cy: DISC, r: 13, class: "frame" }), spoke, dot);
    const words = element("text", { x: toX(i), y: DISC + 29 + (i % 2 ? 14 : 0), class: "mark middle" }, one.name);
    svg.append(words);
    return { one, spoke, dot, i };
  }).filter(Boolean);
  const move = share => {
    curve.setAttribute("d", trace(share));
    for (const { one, spoke, dot, i } of discs) {
      dot.setAttribute("cy", toY(share * one.twist));
      spoke.setAttribute("transform", `rotate(${(ROCK * share * one.twist).toFixed(2)} ${toX(i).toFixed(1)} ${DISC})`);
    }
  };
  return { svg, move };
}
