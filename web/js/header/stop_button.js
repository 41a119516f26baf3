/** <ph-stop-button>: engages the emergency stop with one press, and retries until it is confirmed.
 *
 * It needs neither the stream nor anything else on the page to work.
 */

import { request } from "/web/js/base/api.js";
import { notReachedWords, notStoppedWords } from "/web/js/base/device_words.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { mayMove, standstillWords } from "/web/js/base/state_sentence.js";
import { drawSteps, stopSteps } from "/web/js/header/stop_steps.js";

const ANSWER_MS = 2000;
const RETRY_MS = 500;
const NOTE = "Software stop, not safety-rated";
const NO_ROBOT = "Recording: no robot hears STOP";

class StopButton extends HTMLElement {
  #sending = false;
  #problem = null;
  #isUndelivered = false;
  #latch = null;
  /** When this page sent the stop that is engaged, and when it was answered, ms since 1970. */
  #sentAt = null;
  #answeredAt = null;

  connectedCallback() {
    this.word = el("span", { class: "octagon" }, "STOP");
    this.button = el(
      "button",
      {
        type: "button",
        class: "stop",
        "aria-describedby": "stop-note",
        "aria-keyshortcuts": "Shift+Escape",
        title: "Stop the robot: Shift+Esc",
      },
      this.word,
    );
    this.steps = el("ol", { class: "stop-steps", "aria-label": "Emergency stop" });
    this.standstill = el("p", { class: "standstill" });
    this.unheard = el("p", { class: "unheard" });
    this.note = el("p", { id: "stop-note" }, NOTE);
    this.key = el("p", {}, "Key: ", el("kbd", {}, "Shift+Esc"));
    this.alarm = el("p", { class: "stop-alarm", role: "alert", hidden: true });
    const text = el("div", { class: "stop-text" }, this.steps, this.standstill, this.unheard, this.note, this.key);
    this.append(text, this.button, this.alarm);
    // On pointerdown and not on click: a finger that slides off must still stop the robot.
    this.button.addEventListener("pointerdown", ({ button }) => button === 0 && this.engage());
    this.button.addEventListener("click", () => this.engage());
  }

  /** What is known of the stop: its steps, as `{name, text, isOpen}`. */
  get progress() {
    const at = this.#latch?.since_at ? Date.parse(this.#latch.since_at) : null;
    return stopSteps(this.#latch, { sentAt: this.#sentAt, answeredAt: this.#answeredAt, at });
  }

  update({ live, contact }) {
    this.#latch = live.emergencyStop;
    if (!this.#sending && !this.#latch?.engaged) this.#sentAt = this.#answeredAt = null;
    this.button.disabled = Boolean(live.replay);
    setText(this.note, live.replay ? NO_ROBOT : NOTE);
    setText(this.standstill, this.#latch?.engaged && contact.level !== "lost" ? standstillWords(live) : "");
    setAttribute(this.standstill, "data-moving", mayMove(live));
    const words = this.#latch?.engaged ? notStoppedWords : notReachedWords;
    setText(this.unheard, words(live.devices));
    setAttribute(this.unheard, "title", this.unheard.textContent);
    this.#render();
  }

  /** Engage the emergency stop, and try until that is confirmed. */
  async engage() {
    if (this.#sending || this.button.disabled) return;
    this.#sending = true;
    this.#sentAt = Date.now();
    this.#answeredAt = null;
    this.#render();
    while (!(await this.#put({ engaged: true, reason: "STOP on the monitor page" }))) {
      this.#isUndelivered = true;
      this.#render();
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
    this.#answeredAt = Date.now();
    this.#sending = this.#isUndelivered = false;
    this.#render();
  }

  async #put(body) {
    try {
      const options = { keepalive: true, timeoutMs: ANSWER_MS };
      this.#latch = await request("PUT", "/emergency_stop", body, options);
    } catch (error) {
      this.#problem = error.problem;
      return false;
    }
    this.dispatchEvent(new CustomEvent("ph-latch", { bubbles: true, detail: this.#latch }));
    return true;
  }

  #render() {
    const engaged = Boolean(this.#latch?.engaged);
    const phase = this.#sending ? "sending" : engaged ? "engaged" : "ready";
    setAttribute(this, "data-phase", phase);
    setText(this.word, { sending: "SENDING", engaged: "ENGAGED", ready: "STOP" }[phase]);
    const label = { ready: "STOP", sending: "STOP, sending", engaged: "STOP, engaged" }[phase];
    setAttribute(this.button, "aria-label", label);
    const steps = phase === "ready" ? [] : this.progress;
    drawSteps(this.steps, steps);
    setAttribute(this.steps, "hidden", phase === "ready");
    setAttribute(this.key, "hidden", phase !== "ready" || this.button.disabled);
    setAttribute(this.note, "hidden", phase !== "ready");
    setAttribute(this.alarm, "hidden", !this.#isUndelivered);
    const refused = this.#problem?.status ? ` (${this.#problem.detail})` : "";
    setText(this.alarm, this.#isUndelivered ? `Not delivered. Use the hardware stop.${refused} Retrying.` : "");
  }
}

customElements.define("ph-stop-button", StopButton);
