/** <ph-event-list>: what happened last, newest first; missing events leave a visible line. */

import { el } from "/web/js/dom.js";
import { eventWords } from "/web/js/event_words.js";
import { timeOfDay } from "/web/js/words.js";

const SHOWN = 50;
// What came in, as opposed to what was made of it: many lines, of use when one looks for a cause.
const REPORTS = new Set([
  "signal.read",
  "node.reported",
  "node.answered",
  "vehicle.reported",
  "goal.feedback",
  "goal.ended",
  "time.passed",
  // Beside what the write led to, which has a line of its own.
  "audit.write",
]);

class EventList extends HTMLElement {
  #shown = null;
  #lines = new Map();

  connectedCallback() {
    this.reports = el("input", { type: "checkbox", role: "switch" });
    this.list = el("ol", {
      class: "events",
      tabindex: "0",
      "aria-label": "Recent events, newest first",
    });
    this.append(
      el("label", { class: "switch" }, this.reports, el("span", {}, "Reports too")),
      this.list,
    );
    this.reports.addEventListener("change", () => this.#render());
  }

  update({ state }) {
    if (this.#shown === state.events) return;
    this.#shown = state.events;
    this.#render();
  }

  #render() {
    const wanted = this.#shown.filter((event) => this.reports.checked || !REPORTS.has(event.kind));
    const lines = new Map();
    for (const event of wanted.slice(-SHOWN))
      lines.set(event, this.#lines.get(event) ?? makeLine(event));
    this.#lines = lines;
    this.list.replaceChildren(...[...lines.values()].reverse());
  }
}

function makeLine(event) {
  if (event.note) return el("li", { class: "gap" }, event.note);
  return el(
    "li",
    { "data-kind": event.kind },
    el("time", { datetime: event.at, title: event.at }, timeOfDay(event.at)),
    el("span", { class: "event-kind" }, event.kind),
    el("span", { class: "event-words" }, eventWords(event)),
  );
}

customElements.define("ph-event-list", EventList);
