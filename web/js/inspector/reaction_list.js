/** <ph-reaction-list>: reactions; those that do something, or may not, come first, the others are folded. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import "/web/js/inspector/reaction.js";

class ReactionList extends HTMLElement {
  #lines = new Map();
  #placed = null;

  connectedCallback() {
    if (this.shown) return;
    this.heading = el("h3", {}, "Reactions");
    this.shown = el("ul", { class: "reactions", "aria-label": "Reactions that do something" });
    this.idle = el("ul", { class: "reactions", "aria-label": "Reactions that wait" });
    this.summary = el("summary");
    this.folded = el("details", { class: "unfold" }, this.summary, this.idle);
    this.append(this.heading, this.shown, this.folded);
  }

  /** Show reactions by name, and return how many act. */
  show({ reactions, view }) {
    const all = Object.entries(reactions);
    const calm = all.filter(([, reaction]) => isCalm(reaction));
    const others = all.filter(([, reaction]) => !isCalm(reaction));
    setAttribute(this, "hidden", all.length === 0);
    setAttribute(this.folded, "hidden", calm.length === 0);
    setText(this.summary, `${calm.length} waiting`);
    this.#place(this.shown, others, view);
    this.#place(this.idle, calm, view);
    if (this.#placed !== reactions) this.#forget(reactions);
    this.#placed = reactions;
    return all.filter(([, { state }]) => state === "acting" || state === "exhausted").length;
  }

  /** Show reactions in order; a line that stays is not moved, since a press on it would end. */
  #place(list, entries, view) {
    const names = new Set(entries.map(([name]) => name));
    for (const [name, line] of this.#lines)
      if (line.parentElement === list && !names.has(name)) line.remove();
    entries.forEach(([name, reaction], position) => {
      const line = this.#lines.get(name) ?? el("li", {}, el("ph-reaction"));
      this.#lines.set(name, line);
      if (list.children[position] !== line) list.insertBefore(line, list.children[position] ?? null);
      line.firstChild.show({ name, reaction, view });
    });
  }

  #forget(known) {
    for (const [name, line] of this.#lines) {
      if (name in known) continue;
      line.remove();
      this.#lines.delete(name);
    }
  }
}

/** Whether nothing is to be seen of a reaction: it may act, and nothing calls for it. */
function isCalm({ state, arm }) {
  return state === "idle" && arm === "active";
}

customElements.define("ph-reaction-list", ReactionList);
