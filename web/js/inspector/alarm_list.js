/** <ph-alarm-list>: the errors of the robot and its parts, roots first. */

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
  #view = null;
  #opened = null;

  connectedCallback() {
    if (this.on) return;
    this.on = group("Errors that are on");
    this.returned = group("Errors that are over, and not acknowledged");
    this.over = el("h3", { hidden: true }, "Returned: over, not acknowledged");
    this.silenced = group("Errors that are not announced");
    this.summary = el("summary");
    this.folded = el("details", { class: "unfold", hidden: true }, this.summary, this.silenced);
    this.more = el("button", { type: "button", class: "small", hidden: true });
    this.more.addEventListener("click", () => {
      this.#shown = SHOWN_AT_MOST;
      this.show(this.#view);
    });
    this.left = el("p", { class: "quiet", hidden: true });
    this.append(this.on, this.more, this.left, this.over, this.returned, this.folded);
  }

  /** Show the errors of a view, and return how many roots are in each group.
   *
   * Unless it is `compact`, what comes first is open from the beginning.
   */
  show(view) {
    this.#view = view;
    const { errors } = view.state;
    if (this.#known !== errors) this.#groups = errorGroups(errors);
    this.#known = errors;
    const { on, returned, silenced } = this.#groups;
    setAttribute(this.over, "hidden", returned.length === 0);
    setAttribute(this.folded, "hidden", silenced.length === 0);
    setText(this.summary, `${silenced.length} not announced`);
    const wanted = new Set();
    this.#place(this.on, on, wanted, view);
    this.#place(this.returned, returned, wanted, view);
    this.#place(this.silenced, silenced, wanted, view);
    this.#forget(wanted);
    this.#showRest([on, returned, silenced]);
    return { on: on.length, returned: returned.length, silenced: silenced.length };
  }

  /** Open the first error, or close all. */
  set compact(value) {
    for (const { firstChild: alarm } of this.#lines.values()) alarm.open = false;
    const first = this.on.firstElementChild;
    if (!value && first) this.#openFirst(first.firstChild);
  }

  #showRest(groups) {
    const left = groups.reduce((sum, { length }) => sum + Math.max(0, length - this.#shown), 0);
    const isShort = this.#shown === SHOWN && left > 0;
    setAttribute(this.more, "hidden", !isShort);
    setText(this.more, `Show ${left} more`);
    setAttribute(this.left, "hidden", isShort || left === 0);
    setText(this.left, `and ${left} more`);
    if (left === 0 && groups.every(({ length }) => length <= SHOWN)) this.#shown = SHOWN;
  }

  /** Show the errors of a group in order; an element that stays is moved only if it has to be. */
  #place(list, trees, wanted, view) {
    trees.slice(0, this.#shown).forEach(({ error, below }, position) => {
      const name = errorName(error);
      wanted.add(name);
      const isNew = !this.#lines.has(name);
      const line = this.#lines.get(name) ?? el("li", {}, el("ph-alarm"));
      this.#lines.set(name, line);
      if (list.children[position] !== line) list.insertBefore(line, list.children[position] ?? null);
      line.firstChild.show({ error, below, view });
      if (isNew && list === this.on && position === 0 && !view.compact) this.#openFirst(line.firstChild);
    });
  }

  /** The worst is open; the one that was so before is closed, unless somebody is at it. */
  #openFirst(alarm) {
    if (this.#opened && !this.#opened.matches(":hover, :focus-within")) this.#opened.open = false;
    this.#opened = alarm;
    alarm.open = true;
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
