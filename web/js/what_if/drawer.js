/** <ph-what-if>: what would happen if, on a copy of the live robot in simulated time.
 *
 * The copy is simulated anew whenever the operator has changed something. Nothing here reaches the
 * robot, apart from the switches of its mock, which stand in a place of their own.
 */

import { request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { detailWords } from "/web/js/base/problem.js";
import { timeOfDay } from "/web/js/base/words.js";
import { MockSwitches } from "/web/js/what_if/mock_switches.js";
import { Outcome } from "/web/js/what_if/outcome.js";
import { firstOwnStep, scenarioBody } from "/web/js/what_if/scenario.js";
import { SignalInputs } from "/web/js/what_if/signal_inputs.js";
import { StepInputs } from "/web/js/what_if/step_inputs.js";

const REST_MS = 300;
const REFRESH_MS = 1000;
const TIMEOUT_MS = 60_000;
const SPANS = [
  ["10 s", 10],
  ["30 s", 30],
  ["1 min", 60],
  ["5 min", 300],
  ["30 min", 1800],
];

class WhatIf extends HTMLElement {
  #timer = null;
  #isRunning = false;
  #isAsked = false;
  #shownAt = -Infinity;
  #span = 30;

  connectedCallback() {
    if (this.signals) return;
    const changed = () => this.#ask();
    this.signals = new SignalInputs(changed);
    this.steps = new StepInputs(changed);
    this.outcome = new Outcome();
    this.mock = new MockSwitches();
    this.status = el("p", { class: "quiet", role: "status" });
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.body = el("div", { class: "what-if-columns" }, this.#inputs(), this.#results());
    const frame = el("div", { class: "what-if-frame" }, this.#head(), this.problem, this.body);
    this.append(frame, this.mock.node);
    setAttribute(this, "role", "dialog");
    setAttribute(this, "aria-labelledby", "what-if-title");
    this.addEventListener("keydown", ({ key }) => key === "Escape" && this.close());
    document.addEventListener("ph-tab", () => this.close());
  }

  /** Open the drawer, or bring it back into view. */
  open() {
    if (this.hidden) this.opener = document.activeElement;
    this.hidden = false;
    document.body.dataset.drawer = "what-if";
    this.title_.focus();
    this.#shownAt = -Infinity;
    if (!this.view) return;
    this.update(this.view);
    this.steps.open(this.view.live);
    this.#ask();
  }

  close() {
    if (this.hidden) return;
    this.hidden = true;
    delete document.body.dataset.drawer;
    this.opener?.focus();
  }

  /** The live robot changes beside the simulation; once a second is enough to compare. */
  update(view) {
    this.view = view;
    if (this.hidden) return;
    this.mock.show(view);
    if (performance.now() - this.#shownAt < REFRESH_MS) return;
    this.#shownAt = performance.now();
    this.signals.show(view.live.signals);
    this.outcome.show(view.live);
  }

  #head() {
    this.title_ = el("h2", { id: "what-if-title", tabindex: -1 }, "What if …");
    const close = el("button", { class: "small", onclick: () => this.close() }, "Close");
    return el(
      "div",
      { class: "what-if-head" },
      el("strong", { class: "what-if-mark" }, "SIMULATION"),
      this.title_,
      el("span", { class: "quiet" }, "on a copy of this robot; nothing here reaches it"),
      close,
      this.outcome.headline,
    );
  }

  #inputs() {
    const spans = SPANS.map(([text, span_s]) => el("option", { value: span_s, selected: span_s === this.#span }, text));
    const until = el("select", { "aria-label": "How long to simulate" }, ...spans);
    until.addEventListener("change", () => {
      this.#span = Number(until.value);
      this.#ask();
    });
    const clear = el("button", { class: "small", onclick: () => this.#clear() }, "Begin again");
    return el(
      "div",
      { class: "what-if-inputs" },
      el("div", { class: "what-if-time" }, el("label", {}, "Simulate ", until), clear),
      el("h3", {}, "Signals, from the beginning"),
      this.signals.node,
      el("h3", {}, "And then"),
      this.steps.node,
    );
  }

  #results() {
    return el("div", { class: "what-if-results" }, this.status, this.outcome.node);
  }

  #clear() {
    this.signals.clear();
    this.steps.clear();
    this.#ask();
  }

  /** Simulate when the operator rests, one at a time and then the newest. */
  #ask() {
    clearTimeout(this.#timer);
    setText(this.status, "Simulating …");
    this.#timer = setTimeout(() => this.#run(), REST_MS);
  }

  async #run() {
    if (this.#isRunning) {
      this.#isAsked = true;
      return;
    }
    this.#isRunning = true;
    await this.#simulate();
    this.#isRunning = false;
    if (!this.#isAsked) return;
    this.#isAsked = false;
    this.#run();
  }

  async #simulate() {
    const { live, mock } = this.view;
    const scenario = { signals: this.signals.values, steps: this.steps.steps, until_s: this.#span };
    const body = scenarioBody(scenario, live, mock);
    let problem = null;
    try {
      const result = await request("POST", "/simulations", body, { timeoutMs: TIMEOUT_MS });
      this.#tell(result, body, scenario);
    } catch (error) {
      // Only a bug has no problem; it has to be seen in the console.
      if (!error.problem) throw error;
      problem = refusalWords(error.problem);
      setText(this.status, "");
    }
    setText(this.problem, problem ?? "");
    setAttribute(this.problem, "hidden", problem === null);
    setAttribute(this.body, "hidden", problem === REAL);
  }

  #tell(result, body, scenario) {
    const first = firstOwnStep(body, scenario);
    const refused = result.refusals.map(({ step, problem }) => [step - first, detailWords(problem)]);
    this.steps.tellRefusals(new Map(refused));
    const others = refused.filter(([index]) => index < 0).map(([, words]) => words);
    const copied = `Copied at ${timeOfDay(result.samples[0].system_state.at)}.`;
    setText(this.status, [copied, ...others].join(" "));
    this.outcome.show(this.view.live);
    this.outcome.take(result);
  }
}

const REAL = "This robot is real, and only a simulated one can be copied.";

function refusalWords(problem) {
  const isReal = problem.errors?.some(({ pointer }) => pointer === "/from");
  return isReal ? REAL : `No simulation: ${detailWords(problem)}`;
}

customElements.define("ph-what-if", WhatIf);
