/** <ph-alarm-list>: the errors of the robot and its parts, roots first; hidden while there is none. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { errorGroups, errorName } from "/web/js/base/error_groups.js";
import "/web/js/inspector/alarm.js";

/** Roots that are shown of each group: at first, and when more are asked for; nobody reads more. */
const SHOWN = 5;
const SHOWN_AT_MOST = 50;

class AlarmList extends HTMLElement {
  #lines = new Map();
  #shown = SHOWN;
  #known = null;
  #groups = null;

  connectedCallback() {
    if (this.on) return;
    this.count = el("span", { class: "quiet" });
    this.on = group("Errors that are on");
    this.returned = group("Errors that are over, and not acknowledged");
    this.over = el("h3", { hidden: true }, "Over, not acknowledged");
    this.silenced = group("Errors that are not announced");
    this.summary = el("summary");
    this.folded = el("details", { class: "reasons-of", hidden: true }, this.summary, this.silenced);
    this.more = el("button", { type: "button", class: "small", hidden: true });
    this.more.addEventListener("click", () => (this.#shown = SHOWN_AT_MOST));
    this.left = el("p", { class: "quiet" });
    this.append(
      el("h2", {}, "Errors ", this.count),
      this.on,
      this.over,
      this.returned,
      this.folded,
      this.more,
      this.left,
    );
  }

  update({ state, contact, knownAt, volatile }) {
    if (this.#known !== state.errors) this.#groups = errorGroups(state.errors);
    this.#known = state.errors;
    const { on, returned, silenced } = this.#groups;
    const total = on.length + returned.length + silenced.length;
    setAttribute(this.closest("section"), "hidden", total === 0);
    setText(this.count, on.length ? `(${on.length})` : "");
    setAttribute(this.over, "hidden", returned.length === 0);
    setAttribute(this.folded, "hidden", silenced.length === 0);
    setText(this.summary, `${silenced.length} not announced`);
    const view = { state, enabled: contact.level !== "lost", knownAt, volatile };
    const places = [
      [this.on, on],
      [this.returned, returned],
      [this.silenced, silenced],
    ];
    const wanted = new Set();
    let left = 0;
    for (const [list, trees] of places) {
      left += Math.max(0, trees.length - this.#shown);
      this.#place(list, trees.slice(0, this.#shown), wanted, view);
    }
    const isShort = this.#shown === SHOWN && left > 0;
    setAttribute(this.more, "hidden", !isShort);
    setText(this.more, `Show ${left} more`);
    setText(this.left, left && !isShort ? `and ${left} more` : "");
    if (left === 0 && total <= SHOWN) this.#shown = SHOWN;
    this.#forget(wanted);
  }

  /** Show the errors of a group in order; an element that stays is moved only if it has to be. */
  #place(list, trees, wanted, { state, ...view }) {
    trees.forEach(({ error, below }, position) => {
      const name = errorName(error);
      wanted.add(name);
      const line = this.#lines.get(name) ?? el("li", {}, el("ph-alarm"));
      this.#lines.set(name, line);
      if (list.children[position] !== line) list.insertBefore(line, list.children[position] ?? null);
      line.firstChild.show({ error, below, part: state.parts[error.part], ...view });
    });
  }

  #forget(wanted) {
    for (const [name, line] of this.#lines) {
      if (wanted.has(name)) continue;
      line.remove();
      this.#lines.delete(name);
    }
  }
}

function group(label) {
  return el("ul", { class: "alarms", "aria-label": label });
}

customElements.define("ph-alarm-list", AlarmList);
