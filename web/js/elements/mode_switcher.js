/** <ph-mode-switcher>: buttons for lifecycle and mode, each mode with its first blocker.
 *
 * A mode that cannot be entered is disabled; a blocker that does not refuse is only a warning.
 *
 * Dispatches `ph-change` with the change that the server started, or `ph-problem`.
 */

import { partPath, request } from "/web/js/api.js";
import { el, setAttribute, setText } from "/web/js/dom.js";
import { whileSending } from "/web/js/sending.js";

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
    this.fields = el(
      "fieldset",
      {},
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
      this.modes.set(mode, {
        button,
        mark,
        blocker,
        item: el("div", { class: "mode" }, button, blocker),
      });
    }
    this.modeList.replaceChildren(...[...this.modes.values()].map(({ item }) => item));
  }

  #fill({ mode, can_enter, blockers }) {
    const { button, mark, blocker } = this.modes.get(mode);
    const { actual, target } = this.subject;
    const isActual = actual.mode === mode && actual.state === "active";
    const isTarget = target?.mode === mode;
    setAttribute(button, "disabled", !can_enter);
    setAttribute(button, "aria-pressed", String(isActual));
    setAttribute(button, "aria-describedby", blockers.length ? blocker.id : null);
    setText(mark, isActual ? (this.isLive ? "actual" : "was actual") : isTarget ? "target" : "");
    // What refuses comes first: it is why the button is disabled.
    const sorted = [...blockers].sort((a, b) => refuses(b) - refuses(a));
    const [first, ...others] = sorted;
    const more = others.length ? ` (and ${others.length} more)` : "";
    setText(blocker, first ? `${can_enter ? "⚠ " : ""}${first.message}${more}` : "");
    setAttribute(blocker, "data-advisory", can_enter);
  }

  #ask(button, what, body) {
    const path = `${partPath(this.subject)}/${what}`;
    return whileSending(button, async () => {
      try {
        this.#emit("ph-change", await request("POST", path, body));
      } catch (error) {
        this.#emit("ph-problem", error.problem);
      }
    });
  }

  #emit(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true, detail }));
  }
}

function refuses(blocker) {
  return blocker.refuses === false ? 0 : 1;
}

customElements.define("ph-mode-switcher", ModeSwitcher);
