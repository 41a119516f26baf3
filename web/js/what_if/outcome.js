/** The outcome of a simulation: a play head, the simulated moment beside the live one, its events. */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { compare, stateOf } from "/web/js/what_if/comparison.js";

const SPACE = "http://www.w3.org/2000/svg";
const MOST_EVENTS = 200;

export class Outcome {
  #samples = [];
  #times = [];

  constructor() {
    this.strip = document.createElementNS(SPACE, "svg");
    this.strip.setAttribute("preserveAspectRatio", "none");
    this.strip.setAttribute("aria-hidden", "true");
    this.head = el("input", {
      type: "range",
      min: 0,
      step: 1,
      "aria-label": "Moment of the simulation",
      oninput: () => this.#draw(),
    });
    this.moment = el("output", { class: "what-if-moment" });
    /** The simulated state in a line, for where the table may be out of sight. */
    this.headline = el("span", { class: "what-if-headline narrow-only", "aria-hidden": "true" });
    this.column = el("th", { scope: "col" }, "Simulation");
    this.rows = el("tbody");
    const now = el("th", { scope: "col" }, "Live, now");
    const table = el(
      "table",
      { class: "what-if-outcome" },
      el("caption", { class: "visually-hidden" }, "The robot now, and in the simulation"),
      el("thead", {}, el("tr", {}, el("td"), now, this.column)),
      this.rows,
    );
    this.events = el("ol", { class: "what-if-events" });
    this.quiet = el("p", { class: "quiet" }, "Nothing notable happens.");
    const play = el("div", { class: "what-if-play" }, this.strip, this.head);
    this.node = el(
      "div",
      { hidden: true },
      el("div", { class: "what-if-time" }, el("h3", {}, "Outcome"), this.moment),
      play,
      table,
      el("h3", {}, "What happens"),
      this.events,
      this.quiet,
    );
  }

  /** Show a result of `POST /simulations`; the play head stays at the end if it was there. */
  take({ samples, events }) {
    const wasAtEnd = this.#samples.length === 0 || Number(this.head.value) === this.#samples.length - 1;
    this.#samples = samples;
    this.#times = samples.map(({ t_s }) => t_s);
    this.head.max = samples.length - 1;
    if (wasAtEnd) this.head.value = samples.length - 1;
    this.#drawStrip();
    this.#drawEvents(events, Date.parse(samples[0].system_state.at) - samples[0].t_s * 1000);
    setAttribute(this.node, "hidden", false);
    this.#draw();
  }

  /** Compare with what the live robot is now. */
  show(live) {
    this.live = live;
    if (this.#samples.length) this.#draw();
  }

  #draw() {
    const sample = this.#samples[Number(this.head.value)];
    const words = `${seconds(sample.t_s)} of ${seconds(this.#times.at(-1))}`;
    setText(this.moment, words);
    setAttribute(this.head, "aria-valuetext", words);
    setText(this.column, `Simulation, after ${seconds(sample.t_s)}`);
    const rows = compare(this.live, stateOf(sample));
    setText(this.headline, rows[0].simulated);
    renderOnce(this.rows, JSON.stringify(rows), () =>
      rows.map(({ topic, live, simulated, differs }) =>
        el(
          "tr",
          { "data-differs": differs },
          el("th", { scope: "row" }, topic),
          el("td", {}, live),
          el("td", {}, differs ? mark() : null, simulated),
        ),
      ),
    );
  }

  /** The state of the robot over time, as a bar. */
  #drawStrip() {
    const last = this.#samples.length;
    this.strip.setAttribute("viewBox", `0 0 ${last} 1`);
    let begin = 0;
    const bars = [];
    for (let index = 1; index <= last; index++) {
      const { state } = this.#samples[begin].system_state;
      if (index < last && this.#samples[index].system_state.state === state) continue;
      const bar = document.createElementNS(SPACE, "path");
      bar.setAttribute("d", `M${begin} 0H${index}V1H${begin}z`);
      bar.setAttribute("class", `bar-${state.toLowerCase()}`);
      bars.push(bar);
      begin = index;
    }
    this.strip.replaceChildren(...bars);
  }

  #drawEvents(events, begin) {
    const notable = events.filter((event) => event.notable);
    const rows = notable.slice(0, MOST_EVENTS).map(({ at, words }) => {
      const t_s = (Date.parse(at) - begin) / 1000;
      return el(
        "li",
        {},
        el("button", { onclick: () => this.#goTo(t_s) }, seconds(t_s)),
        el("span", {}, words),
      );
    });
    const more = notable.length - rows.length;
    if (more > 0) rows.push(el("li", { class: "quiet" }, `and ${more} more`));
    this.events.replaceChildren(...rows);
    setAttribute(this.quiet, "hidden", rows.length > 0);
  }

  #goTo(t_s) {
    const index = this.#times.findIndex((own) => own >= t_s - 1e-6);
    this.head.value = index < 0 ? this.#times.length - 1 : index;
    this.#draw();
  }
}

function mark() {
  return el("span", { class: "what-if-differs", title: "differs from the live robot" }, "≠ ");
}

function seconds(value_s) {
  return value_s < 60 ? `${value_s.toFixed(1)} s` : `${Math.floor(value_s / 60)} min ${Math.round(value_s % 60)} s`;
}
