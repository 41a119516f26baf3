/** <ph-mode-switcher>: buttons for lifecycle and mode, each mode with its first blocker.
 *
 * A mode that cannot be entered is disabled; a blocker that does not refuse is only a warning. What
 * is behind the first blocker, and the conditions of a mode, can be opened beside it. There a request
 * can be sent that waits until the conditions are met; the server rejects it if waiting cannot help.
 *
 * Dispatches `ph-change` with the change that the server started, or `ph-problem`; `ph-plan` with the
 * plan of it, if that is to be seen first.
 */

import { partPath, request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { nearestWords, reasonTree } from "/web/js/base/reasons.js";
import { requestPlan } from "/web/js/inspector/part_watch.js";
import { whileSending } from "/web/js/base/sending.js";

const WAIT_S = 600;
const TRANSITIONS = ["configure", "activate", "deactivate", "cleanup", "shutdown"];

class ModeSwitcher extends HTMLElement {
  connectedCallback() {
    if (this.fields) return;
    this.transitions = new Map();
    const lifecycle = el("div", { class: "buttons", role: "group", "aria-label": "Lifecycle" });
    for (const name of TRANSITIONS) {
      const button = this.#transitionButton(name);
      this.transitions.set(name, button);
      lifecycle.append(button);
    }
    this.modes = new Map();
    this.modeList = el("div", { class: "modes", role: "group", "aria-label": "Mode" });
    this.modeTitle = el("h3", {}, "Mode");
    this.planFirst = el("input", { type: "checkbox", role: "switch" });
    const planFirst = el("label", { class: "switch" }, this.planFirst, "Show the plan first");
    this.fields = el(
      "fieldset",
      {},
      planFirst,
      this.modeTitle,
      this.modeList,
      el("h3", {}, "Lifecycle"),
      lifecycle,
    );
    this.append(this.fields);
  }

  show({ part, transitions, modes, enabled }) {
    this.subject = part;
    this.isLive = enabled;
    setAttribute(this.fields, "disabled", !enabled);
    for (const [name, button] of this.transitions) {
      const off = !transitions.includes(name);
      if (name === "shutdown") button.disabled = off;
      else setAttribute(button, "disabled", off);
    }
    setAttribute(this.modeTitle, "hidden", modes.length === 0);
    const key = modes.map((item) => item.mode).join("\n");
    if (this.key !== key) this.#build(key, modes);
    for (const item of modes) this.#fill(item);
  }

  /** A finalized part cannot be restarted, so shutdown needs a long press. */
  #transitionButton(name) {
    if (name === "shutdown") {
      const shutdown = el("ph-hold-button", { label: "shutdown (hold)" });
      shutdown.addEventListener("ph-held", () =>
        this.#ask(shutdown.button, "state", { transition: name }),
      );
      return shutdown;
    }
    const button = el("button", { type: "button" }, name);
    button.addEventListener("click", () => this.#ask(button, "state", { transition: name }));
    return button;
  }

  #build(key, modes) {
    this.key = key;
    this.modes.clear();
    for (const { mode } of modes) {
      const blocker = el("p", { class: "blocker", id: `blocker-${mode}` });
      const mark = el("span", { class: "mark" });
      const button = el("button", { type: "button" }, el("span", {}, mode), mark);
      button.addEventListener("click", () => this.#ask(button, "mode", { mode }));
      const details = this.#details(mode);
      const item = el("div", { class: "mode" }, button, blocker, details.whole);
      this.modes.set(mode, { button, mark, blocker, details, item });
    }
    this.modeList.replaceChildren(...[...this.modes.values()].map(({ item }) => item));
  }

  /** Built only while it is open, since a tree of reasons may be long. */
  #details(mode) {
    const [title, content] = [el("span"), el("div")];
    const summary = el("summary", {}, title, el("span", { class: "visually-hidden" }, ` ${mode}`));
    const whole = el("details", { class: "reasons-of" }, summary, content);
    const body = { mode, wait_for_s: WAIT_S };
    const wait = (button) => this.#send(button, "mode", body);
    const details = { whole, title, content, wait, item: null };
    whole.addEventListener("toggle", () => fillDetails(details));
    return details;
  }

  #fill(shown) {
    const { mode, can_enter, can_stay, blockers } = shown;
    const { button, mark, blocker, details } = this.modes.get(mode);
    const { actual, target } = this.subject;
    const isActual = actual.mode === mode && actual.state === "active";
    const isTarget = target?.mode === mode;
    setAttribute(button, "disabled", !can_enter);
    setAttribute(button, "aria-pressed", String(isActual));
    setAttribute(button, "aria-describedby", blockers.length ? blocker.id : null);
    const here = this.isLive ? "actual" : "was actual";
    const stays = can_stay === false ? ", cannot stay" : "";
    setText(mark, `${isActual ? here : isTarget ? "target" : ""}${stays}`.replace(/^, /, ""));
    // What refuses comes first: it is why the button is disabled.
    const sorted = [...blockers].sort((a, b) => refuses(b) - refuses(a));
    const [first, ...others] = sorted;
    const more = others.length ? ` (and ${others.length} more)` : "";
    setText(blocker, first ? `${can_enter ? "⚠ " : ""}${nearestWords(first)}${more}` : "");
    setAttribute(blocker, "data-advisory", can_enter);
    details.item = { ...shown, blockers: sorted };
    fillDetails(details);
  }

  #ask(button, what, body) {
    if (!this.planFirst.checked) return this.#send(button, what, body);
    const path = `${partPath(this.subject)}/${what}`;
    return this.#whileAsking(button, async () =>
      this.#emit("ph-plan", await requestPlan({ path, body })),
    );
  }

  #send(button, what, body) {
    const path = `${partPath(this.subject)}/${what}`;
    return this.#whileAsking(button, async () =>
      this.#emit("ph-change", await request("POST", path, body)),
    );
  }

  #whileAsking(button, act) {
    return whileSending(button, async () => {
      try {
        await act();
      } catch (error) {
        this.#emit("ph-problem", error.problem);
      }
    });
  }

  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true, detail }));
  }
}

function fillDetails({ whole, title, content, wait, item }) {
  const { can_enter, blockers, requires = [], invariants = [] } = item ?? { blockers: [] };
  setAttribute(whole, "hidden", blockers.length + requires.length + invariants.length === 0);
  setText(title, blockers.length === 0 ? "Conditions" : can_enter ? "Why the warning" : "Why not");
  if (!whole.open) return;
  renderOnce(content, JSON.stringify([can_enter, blockers, requires, invariants]), () => [
    ...(blockers.length ? [reasonTree(blockers)] : []),
    ...(can_enter ? [] : [waitButton(wait)]),
    ...conditionList("Required to enter", requires),
    ...conditionList("Required to enter and to stay", invariants),
  ]);
}

function waitButton(wait) {
  const words = `Enter as soon as it may, within ${WAIT_S / 60} min`;
  const button = el("button", { type: "button" }, words);
  button.addEventListener("click", () => wait(button));
  return button;
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
