/** <ph-event-list>: recent events, newest first; a line marks missing events. */

import { el } from "/web/js/dom.js";
import { timeOfDay } from "/web/js/words.js";

const SHOWN = 50;

class EventList extends HTMLElement {
  #shown = null;
  #lines = new Map();

  connectedCallback() {
    this.details = el("input", { type: "checkbox", role: "switch" });
    this.list = el("ol", {
      class: "events",
      tabindex: "0",
      "aria-label": "Recent events, newest first",
    });
    this.append(
      el("label", { class: "switch" }, this.details, el("span", {}, "Show details")),
      this.list,
    );
    this.details.addEventListener("change", () => this.#render());
  }

  update({ state }) {
    if (this.#shown === state.events) return;
    this.#shown = state.events;
    this.#render();
  }

  #render() {
    const wanted = this.#shown.filter((event) => this.details.checked || isNotable(event));
    const lines = new Map();
    for (const event of wanted.slice(-SHOWN))
      lines.set(event, this.#lines.get(event) ?? makeLine(event));
    this.#lines = lines;
    this.list.replaceChildren(...[...lines.values()].reverse());
  }
}

/** Notable events are always shown, and so are lines for missing events. */
function isNotable(event) {
  return Boolean(event.note) || event.notable;
}

function makeLine(event) {
  if (event.note) return el("li", { class: "gap" }, event.note);
  return el(
    "li",
    { "data-kind": event.kind },
    el("time", { datetime: event.at, title: event.at }, timeOfDay(event.at)),
    el("span", { class: "event-words" }, event.words),
    el("span", { class: "event-kind" }, event.kind),
  );
}

customElements.define("ph-event-list", EventList);
