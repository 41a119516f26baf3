/** <ph-mock-control>: sets the value that a mock signal publishes, and whether it publishes. */

import { request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { makeInput, makeSwitch } from "/web/js/what_if/control.js";

const MIN_GAP_MS = 100;
const REST_MS = 800;

class MockControl extends HTMLElement {
  #signal = null;
  #mock = null;
  #waiting = null;
  #sending = false;
  #touchedAt = -Infinity;
  #dragging = false;

  /** Build the control for one signal. */
  open(signal, { label, control }) {
    this.#signal = signal;
    this.input = makeInput(control, label);
    this.publishing = makeSwitch("Publishing", `${label}: publishing`);
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.fields = el("fieldset", {}, el("legend", {}, label), this.input.node, this.publishing.node);
    this.append(this.fields, this.problem);
    this.publishing.box.addEventListener("change", () =>
      this.#ask({ publishing: this.publishing.box.checked }),
    );
    const field = this.input.field;
    field.addEventListener("input", () => this.#ask({ value: this.input.read() }));
    if (control.kind !== "range") return;
    field.addEventListener("pointerdown", () => (this.#dragging = true));
    for (const end of ["pointerup", "pointercancel", "change"]) {
      field.addEventListener(end, () => (this.#dragging = false));
    }
  }

  /** Show incoming values, except while a user operates the control; `mock` is from /mock. */
  show(signal, mock, enabled) {
    setAttribute(this.fields, "disabled", !enabled);
    if (this.#dragging || performance.now() - this.#touchedAt < REST_MS) return;
    if (this.#mock !== mock) {
      this.#mock = mock;
      this.publishing.box.checked = mock.publishing;
      this.input.write(mock.value);
    }
    if (this.publishing.box.checked && signal.value !== null) this.input.write(signal.value);
  }

  /** Send the newest setting, at most ten per second and one at a time. */
  async #ask(wish) {
    this.#touchedAt = performance.now();
    this.#waiting = { ...this.#waiting, ...wish };
    if (this.#sending) return;
    this.#sending = true;
    while (this.#waiting) {
      const body = this.#waiting;
      this.#waiting = null;
      const gap = new Promise((resolve) => setTimeout(resolve, MIN_GAP_MS));
      await this.#send(body);
      await gap;
    }
    this.#touchedAt = performance.now();
    this.#sending = false;
  }

  async #send(body) {
    let problem = null;
    try {
      await request("PATCH", `/mock/${encodeURIComponent(this.#signal)}`, body);
    } catch (error) {
      problem = error.message;
    }
    setText(this.problem, problem ?? "");
    setAttribute(this.problem, "hidden", problem === null);
  }
}

customElements.define("ph-mock-control", MockControl);
