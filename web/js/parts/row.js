/** One row of a list of parts: dot, name, what is wrong below, target and actual, age, cause. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { label, modeName } from "/web/js/base/words.js";
import { splitName } from "/web/js/parts/lines.js";
import { causeWords, LOOK_WORDS, missedTarget } from "/web/js/parts/verdict.js";

/** Make an empty row for a list whose rows have this role. */
export function makeRow(role) {
  const row = {
    seen: [],
    twist: el("span", { class: "twist", "aria-hidden": "true" }),
    dot: el("span", { class: "dot" }),
    start: el("span", { class: "name-start" }),
    end: el("span", { class: "name-end" }),
    space: el("span", { class: "name-space" }),
    device: el("span", { class: "on-device" }),
    below: el("span", { class: "below" }),
    fit: el("span", { class: "fit" }),
    age: el("span", { class: "age" }),
    cause: el("span", { class: "cause" }),
  };
  row.name = el("span", { class: "name" }, row.start, row.end, row.space);
  const parts = [row.twist, row.dot, row.name, row.device, row.below, row.fit, row.age, row.cause];
  row.item = el("li", { role }, ...parts);
  return row;
}

/** Bring a row up to date; nothing is touched while all that it shows is as it was.
 *
 * `told` is what is known of the part: `{part, device, isOld, look, errors, below, age, isSelected,
 * hasFocus, width}`, the width of the list in px.
 */
export function fillRow(row, line, told) {
  const seen = [line, ...Object.values(told)];
  if (seen.every((value, at) => value === row.seen[at])) return;
  row.seen = seen;
  const { item } = row;
  item.line = line;
  if (line.heading) return fillHeading(row, line);
  const { part, device, isOld, look, errors, below, age, isSelected, hasFocus, width } = told;
  setAttribute(item, "class", "row");
  setAttribute(item, "aria-hidden", null);
  setAttribute(item, "aria-level", line.level);
  setAttribute(item, "aria-posinset", line.index);
  setAttribute(item, "aria-setsize", line.count);
  setAttribute(item, "aria-expanded", line.open === null ? null : String(line.open));
  setAttribute(item, "aria-selected", String(isSelected));
  setAttribute(item, "tabindex", hasFocus ? 0 : -1);
  setAttribute(item, "data-look", look);
  setAttribute(item, "data-old", isOld);
  setAttribute(row.dot, "data-look", look);
  item.style.setProperty("--level", line.level ?? 1);
  fillName(row, line);
  setText(row.device, device);
  setAttribute(row.device, "title", device ? `on device ${device}` : null);
  const isFolded = below !== null && line.open !== true;
  setText(row.below, isFolded ? String(below.count) : "");
  setAttribute(row.below, "data-look", isFolded ? below.worst : null);
  fillFit(row.fit, part, { look, below, isOld });
  const taken = (isFolded ? BADGE_PX : 0) + device.length * FIT_PX;
  setAttribute(item, "data-tight", isTight(line, row.fit, width - taken));
  setText(row.age, age);
  const cause = causeWords(part, errors);
  setText(row.cause, cause);
  setAttribute(row.cause, "title", cause);
  setAttribute(item, "aria-label", spoken(line.name, told, isFolded, cause));
}

function fillHeading(row, { heading, level }) {
  const { item } = row;
  setAttribute(item, "class", "space");
  // Each row below says its whole name.
  setAttribute(item, "aria-hidden", "true");
  setAttribute(item, "tabindex", null);
  item.style.setProperty("--level", level);
  fillName(row, { name: heading, shown: `${heading}/`, space: "" });
  for (const empty of [row.device, row.below, row.age, row.cause]) setText(empty, "");
  row.fit.replaceChildren();
  row.fit.key = "";
}

function fillName({ start, end, space: aside, name: node }, { name, shown, space }) {
  setAttribute(node, "title", name);
  const [head, tail] = splitName(shown);
  setText(start, head);
  setText(end, tail);
  setText(aside, space);
}

/** Whether name and pill are longer together than a list of this width has room for.
 *
 * Counted and not measured: a layout for each row of each frame would cost more than it is worth.
 */
function isTight({ shown, level = 1 }, fit, width) {
  const needed = shown.length * NAME_PX + fit.textContent.length * FIT_PX;
  return needed > width - OTHERS_PX - level * LEVEL_PX;
}

/** The widest that a letter of a name and of a pill are on average, and what stands beside both. */
const [NAME_PX, FIT_PX, LEVEL_PX, BADGE_PX, OTHERS_PX] = [7.3, 6.7, 13, 25, 106];

/** The target only where it is missed; then what both have in common is left out.
 *
 * Of a system in which something below is missed, the badge tells that.
 */
function fillFit(fit, part, { look, below, isOld }) {
  const { actual } = part;
  const old = isOld ? part.last_known : null;
  const wanted = below ? null : missedTarget(part);
  const isAway = look === "unreachable";
  const key = `${isAway}|${old ? label(old) : ""}|${stateWords(actual)}|${wanted ? stateWords(wanted) : ""}`;
  if (fit.key === key) return;
  fit.key = key;
  fit.title = wanted ? `target ${stateWords(wanted)}, actual ${stateWords(actual)}` : "";
  if (old) fit.title = `last known: ${label(old)}`;
  if (isAway) return fit.replaceChildren(...(old ? actualWords(old, true) : ["unreachable"]));
  if (!wanted) return fit.replaceChildren(...actualWords(actual, true));
  const isModeOnly = wanted.state === actual.state && wanted.mode;
  fit.replaceChildren(
    el("span", { class: "wanted" }, isModeOnly ? modeName(wanted.mode) : short(wanted)),
    el("span", { class: "arrow" }, "→"),
    ...actualWords(actual, !isModeOnly),
  );
}

/** Inferred is italic with (*), as in the mode monitor of system_modes. */
function actualWords({ state, mode, inferred, mode_inferred }, hasState) {
  if (state === "unknown") return [el("b", { title: "not known" }, "?")];
  const said = hasState || mode ? [] : [el("b", { title: "mode not known" }, "?")];
  const has = (kind, isInferred) => ({ class: isInferred ? `${kind} inferred` : kind });
  if (hasState && mode) said.push(el("span", has("before", inferred), `${state}.`));
  else if (hasState) said.push(el("span", has("state", inferred), state));
  if (mode) said.push(el("span", has("mode", mode_inferred), modeName(mode)));
  if (inferred || mode_inferred)
    said.push(el("span", { class: "star", title: "inferred, not reported" }, " (*)"));
  return said;
}

function short({ state, mode }) {
  return mode && mode !== "__DEFAULT__" ? mode : state;
}

function stateWords(actual) {
  if (actual.state === "unknown") return "not known";
  return actual.inferred || actual.mode_inferred ? `${label(actual)} (*)` : label(actual);
}

/** What a screen reader says of the row, without the age, which would not let it rest. */
function spoken(name, { part, device, isOld, look, below }, isFolded, cause) {
  const wanted = missedTarget(part);
  const said = [
    `${name} ${part.kind ?? "part"}`,
    device && `on device ${device}`,
    stateWords(part.actual).replace("(*)", "inferred"),
    isOld && part.last_known && `last known ${label(part.last_known)}`,
    wanted && `target ${stateWords(wanted)}`,
    LOOK_WORDS[look],
    // What a row shows as its pill was said.
    cause !== LOOK_WORDS[look] && !cause.startsWith("target ") && cause,
    isFolded && `${below.count} below: ${LOOK_WORDS[below.worst]}`,
  ];
  return said.filter(Boolean).join(", ");
}

/** "12 s", "5 min", "3 h", "2 d": whole units, since a row has little room. */
export function ageWords(ms) {
  const s = Math.max(0, Math.floor(ms / 1000));
  if (s < 60) return `${s} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min`;
  if (s < 172_800) return `${Math.floor(s / 3600)} h`;
  return `${Math.floor(s / 86_400)} d`;
}
