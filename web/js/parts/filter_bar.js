/** What of the parts is listed: a text, and all of them or those that need attention. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { ATTENTION, RANKS } from "/web/js/parts/verdict.js";

/** Which looks each kind of attention lets through. */
const KINDS = {
  any: (look) => RANKS[look] >= ATTENTION,
  deviating: (look) => look === "deviating",
  faulty: (look) => look === "warned" || RANKS[look] >= RANKS.faulty,
};

export class FilterBar {
  words = [];
  isAttention = false;
  /** A key of KINDS. */
  kind = "any";

  /** `changed()` is called after each change; `leave()` when the arrow down leads to the list. */
  constructor({ changed, leave }) {
    this.changed = changed;
    this.input = el("input", {
      type: "search",
      placeholder: "Filter",
      "aria-label": "Filter parts by name",
      autocomplete: "off",
      spellcheck: "false",
      oninput: () => this.#type(),
      onkeydown: (event) => this.#key(event, leave),
    });
    this.all = choice("parts-shown", "All", true, () => this.attend(false));
    this.attention = choice("parts-shown", "Attention", false, () => this.attend(true));
    this.kinds = Object.keys(KINDS).map((kind) => {
      const words = kind === "any" ? "Any" : `${kind[0].toUpperCase()}${kind.slice(1)}`;
      return choice("parts-kind", words, kind === "any", () => this.#choose(kind));
    });
    this.more = choices("Kind of attention", this.kinds);
    this.node = el(
      "div",
      { class: "filter" },
      el("div", { class: "filter-line" }, this.input, choices("Parts shown", [this.all, this.attention])),
      this.more,
    );
    setAttribute(this.more, "hidden", true);
  }

  /** List only what needs attention, or all. */
  attend(isAttention) {
    this.isAttention = isAttention;
    (isAttention ? this.attention : this.all).input.checked = true;
    setAttribute(this.more, "hidden", !isAttention);
    this.changed();
  }

  /** Return whether a part of this look is let through. */
  lets(look) {
    return KINDS[this.kind](look);
  }

  /** Tell of how many parts each choice consists. */
  count(looks) {
    setText(this.attention.count, looks.length > 0 ? String(looks.length) : "");
    setAttribute(this.attention.label, "data-some", looks.length > 0);
    Object.keys(KINDS).forEach((kind, at) =>
      setText(this.kinds[at].count, String(looks.filter(KINDS[kind]).length)),
    );
  }

  #type() {
    this.words = this.input.value.toLowerCase().split(/\s+/).filter(Boolean);
    this.changed();
  }

  #choose(kind) {
    this.kind = kind;
    this.changed();
  }

  #key(event, leave) {
    if (event.key === "Escape" && this.input.value !== "") {
      this.input.value = "";
      this.#type();
    } else if (event.key === "ArrowDown") leave();
    else return;
    event.preventDefault();
    event.stopPropagation();
  }
}

function choices(label, options) {
  const labels = options.map((option) => option.label);
  return el("div", { class: "choices", role: "radiogroup", "aria-label": label }, ...labels);
}

function choice(name, words, checked, onchange) {
  const input = el("input", { type: "radio", name, checked, onchange });
  const count = el("span", { class: "count" });
  return { input, count, label: el("label", { class: "choice" }, input, el("span", {}, words), count) };
}
