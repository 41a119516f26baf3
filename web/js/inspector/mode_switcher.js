/** <ph-mode-switcher>: the modes of a part as one radio group, each with its first blocker.
 *
 * Few short names stand side by side, as one control; others below each other. The arrow keys only
 * move: since a mode moves the robot, it is chosen by Space, Enter or a press. A mode that cannot be
 * entered stays in reach; a press on it opens why not. There a request can be sent that waits until
 * the conditions are met; the server rejects it if waiting cannot help.
 *
 * Dispatches `ph-ask` with the `{button, what, body}` of a request.
 */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { nearestWords, reasonTree } from "/web/js/base/reasons.js";
import { plainMessage } from "/web/js/base/signal_words.js";
import { modeName } from "/web/js/base/words.js";

const WAIT_S = 600;
/** Characters that fit beside each other. */
const LINE = 36;
const STEPS = { ArrowRight: 1, ArrowDown: 1, ArrowLeft: -1, ArrowUp: -1 };

class ModeSwitcher extends HTMLElement {
  #modes = new Map();
  #key = "";

  connectedCallback() {
    if (this.group) return;
    this.group = el("div", { class: "modes", role: "radiogroup", "aria-label": "Mode" });
    this.group.addEventListener("keydown", (event) => this.#move(event));
    this.append(this.group);
  }

  /** Show modes as `GET P/modes` has them; `isLive`: what they say of the part is of now. */
  show({ part, modes, enabled, isLive, signals }) {
    this.subject = part;
    this.words = (text) => plainMessage(text, signals);
    this.isLive = isLive;
    const key = modes.map(({ mode }) => mode).join("\n");
    if (this.#key !== key) this.#build(key, modes);
    for (const item of modes) this.#fill(item, enabled);
    this.#chooseStop();
  }

  #build(key, modes) {
    this.#key = key;
    this.#modes.clear();
    setAttribute(this.group, "data-columns", columnsFor(modes.map(({ mode }) => modeName(mode))));
    for (const { mode } of modes) this.#modes.set(mode, this.#made(mode));
    this.group.replaceChildren(...[...this.#modes.values()].map(({ item }) => item));
  }

  #made(mode) {
    const mark = el("span", { class: "mark" });
    const name = el("span", { class: "mode-name" }, modeName(mode));
    const button = el("button", { type: "button", role: "radio", title: modeName(mode) }, name, mark);
    const blocker = el("span", { class: "blocker", id: `blocker-${mode}` });
    const [title, content] = [el("span"), el("div")];
    const of = el("span", {}, ` ${modeName(mode)}`);
    const summary = el("summary", {}, el("span", { class: "why-not" }, title, of), blocker);
    const whole = el("details", { class: "unfold" }, summary, content);
    const line = { mode, button, mark, blocker, whole, title, content, item: null };
    line.item = el("div", { class: "mode" }, button, whole);
    button.addEventListener("click", () => this.#press(line));
    // Built only while it is open, since a tree of reasons may be long.
    whole.addEventListener("toggle", () => this.#fillDetails(line));
    return line;
  }

  #press(line) {
    const { button, whole, mode } = line;
    if (button.getAttribute("aria-disabled") !== "true") this.#ask(button, { mode });
    else if (!whole.hidden) whole.open = true;
  }

  #ask(button, body) {
    const detail = { button, what: "mode", body };
    this.dispatchEvent(new CustomEvent("ph-ask", { bubbles: true, detail }));
  }

  #fill(shown, enabled) {
    const { mode, can_enter, can_stay, blockers } = shown;
    const line = this.#modes.get(mode);
    const { actual, target } = this.subject;
    const isActual = actual.mode === mode && actual.state === "active";
    const isTarget = target?.mode === mode;
    setAttribute(line.button, "disabled", !enabled);
    setAttribute(line.button, "aria-disabled", can_enter ? null : "true");
    setAttribute(line.button, "aria-checked", String(isActual));
    setAttribute(line.button, "data-target", isTarget);
    setAttribute(line.button, "aria-describedby", blockers.length ? line.blocker.id : null);
    const here = this.isLive ? "actual" : "was actual";
    const stays = can_stay === false ? ", cannot stay" : "";
    setText(line.mark, `${isActual ? here : isTarget ? "target" : ""}${stays}`.replace(/^, /, ""));
    // What refuses comes first: it is why the mode cannot be entered.
    const sorted = [...blockers].sort((a, b) => refuses(b) - refuses(a));
    const [first, ...others] = sorted;
    const more = others.length ? ` (and ${others.length} more)` : "";
    setText(line.blocker, first ? `${can_enter ? "⚠ " : ""}${this.words(nearestWords(first))}${more}` : "");
    setAttribute(line.blocker, "data-advisory", can_enter);
    line.shown = { ...shown, blockers: sorted };
    this.#fillDetails(line);
  }

  #fillDetails({ whole, title, content, shown, mode }) {
    const { can_enter, blockers, requires = [], invariants = [] } = shown;
    setAttribute(whole, "hidden", blockers.length + requires.length + invariants.length === 0);
    setText(title, blockers.length === 0 ? "Conditions of" : can_enter ? "Warning for" : "Why not");
    if (!whole.open) return;
    renderOnce(content, JSON.stringify([can_enter, blockers, requires, invariants]), () => [
      ...(blockers.length ? [reasonTree(blockers, this.words)] : []),
      ...(can_enter ? [] : [this.#waitButton(mode)]),
      ...conditionList("Required to enter", requires),
      ...conditionList("Required to enter and to stay", invariants),
    ]);
  }

  #waitButton(mode) {
    const words = `Enter as soon as it may, within ${WAIT_S / 60} min`;
    const button = el("button", { type: "button", class: "small" }, words);
    button.addEventListener("click", () => this.#ask(button, { mode, wait_for_s: WAIT_S }));
    return button;
  }

  /** One radio of the group is a stop of Tab: the one with the focus, else the actual, else the first. */
  #chooseStop() {
    const buttons = [...this.#modes.values()].map(({ button }) => button);
    const stop =
      buttons.find((button) => button === document.activeElement) ??
      buttons.find((button) => button.getAttribute("aria-checked") === "true") ??
      buttons[0];
    for (const button of buttons) setAttribute(button, "tabindex", button === stop ? 0 : -1);
  }

  #move(event) {
    const buttons = [...this.#modes.values()].map(({ button }) => button);
    const at = buttons.indexOf(event.target);
    const ends = { Home: 0, End: buttons.length - 1 };
    const to = ends[event.key] ?? (at + STEPS[event.key] + buttons.length) % buttons.length;
    if (at < 0 || !(to >= 0)) return;
    event.preventDefault();
    buttons[to].focus();
    this.#chooseStop();
  }
}

/** In how many columns names stand; more than one makes them one control. */
function columnsFor(names) {
  const longest = Math.max(0, ...names.map((name) => name.length));
  if (names.length > 4) return 1;
  if (names.length * longest <= LINE) return Math.max(1, names.length);
  return names.length % 2 === 0 && 2 * longest <= LINE ? 2 : 1;
}

function conditionList(title, conditions) {
  if (conditions.length === 0) return [];
  const items = conditions.map((text) => el("li", {}, el("code", {}, text)));
  return [el("h4", {}, title), el("ul", { class: "conditions" }, ...items)];
}

function refuses(blocker) {
  return blocker.refuses === false ? 0 : 1;
}

customElements.define("ph-mode-switcher", ModeSwitcher);
