/** <ph-event-list>: what happened last, newest first; missing events leave a visible line. */

import { el } from "/web/js/dom.js";
import { eventWords, timeOfDay } from "/web/js/words.js";

class EventList extends HTMLElement {
  #shown = null;
  #lines = new Map();

  connectedCallback() {
    this.list = el("ol", { class: "events", tabindex: "0", "aria-label": "Recent events, newest first" });
    this.append(this.list);
  }

  update({ state }) {
    if (this.#shown === state.events) return;
    this.#shown = state.events;
    const lines = new Map();
    for (const event of state.events) lines.set(event, this.#lines.get(event) ?? makeLine(event));
    this.#lines = lines;
    this.list.replaceChildren(...[...lines.values()].reverse());
  }
}

function makeLine(event) {
  if (event.note) return el("li", { class: "gap" }, event.note);
  return el(
    "li",
    {},
    el("time", { datetime: event.at, title: event.at }, timeOfDay(event.at)),
    el("span", { class: "event-kind" }, event.kind),
    el("span", { class: "event-words" }, eventWords(event)),
  );
}

customElements.define("ph-event-list", EventList);
