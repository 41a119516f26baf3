/** <ph-stop-button>: engages the emergency stop with one press, and retries until it is confirmed.
 *
 * It needs neither the stream nor anything else on the page to work.
 */

import { request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { mayMove, standstillWords } from "/web/js/base/state_sentence.js";
import { timeOfDay } from "/web/js/base/words.js";

const ANSWER_MS = 2000;
/** A release waits up to 2 s for the disk before it is carried out, and as long for its outcome. */
const RELEASED_MS = 8000;
const RETRY_MS = 500;
const NOTE = "Software stop, not safety-rated";
const NO_ROBOT = "This is a recording: no robot hears STOP here";

class StopButton extends HTMLElement {
  #sending = false;
  #undelivered = false;
  #problem = null;
  #latch = null;
  #stands = "";
  #moves = false;

  connectedCallback() {
    this.word = el("span", { class: "octagon" }, "STOP");
    this.button = el(
      "button",
      { type: "button", class: "stop", "aria-describedby": "stop-note" },
      this.word,
    );
    this.status = el("p", { class: "stop-status", "aria-live": "assertive" });
    this.note = el("p", { id: "stop-note", class: "quiet" }, NOTE);
    this.release = el("ph-hold-button", { label: "Release the stop (hold)", hidden: true });
    this.by = el("p", { class: "quiet" });
    this.standstill = el("p", { class: "standstill" });
    const text = el(
      "div",
      { class: "stop-text" },
      this.status,
      this.standstill,
      this.by,
      this.release,
      this.note,
    );
    this.append(text, this.button);
    // On pointerdown and not on click: a finger that slides off must still stop the robot.
    this.button.addEventListener("pointerdown", ({ button }) => button === 0 && this.#engage());
    this.button.addEventListener("click", () => this.#engage());
    this.release.addEventListener("ph-held", ({ detail }) => this.#release(detail.volatile));
  }

  update({ state, contact, volatile }) {
    this.#latch = state.emergencyStop;
    this.#moves = mayMove(state);
    this.#stands = contact.level === "lost" ? "" : standstillWords(state);
    this.release.disabled = contact.level === "lost" || Boolean(state.replay);
    this.release.volatile = volatile;
    this.button.disabled = Boolean(state.replay);
    setText(this.note, state.replay ? NO_ROBOT : NOTE);
    this.#render();
  }

  async #engage() {
    if (this.#sending || this.button.disabled) return;
    this.#sending = true;
    this.#problem = null;
    this.#render();
    while (!(await this.#put({ engaged: true, reason: "STOP on the monitor page" }, ANSWER_MS))) {
      this.#undelivered = true;
      this.#render();
      await new Promise((resolve) => setTimeout(resolve, RETRY_MS));
    }
    this.#sending = this.#undelivered = false;
    this.#render();
  }

  async #release(volatile) {
    const body = { engaged: false, reason: "released on the monitor page" };
    if (volatile) body.volatile = true;
    await whileSending(this.release.button, () => this.#put(body, RELEASED_MS));
    this.#render();
  }

  async #put(body, timeoutMs) {
    try {
      const options = { keepalive: true, timeoutMs };
      this.#latch = await request("PUT", "/emergency_stop", body, options);
      this.#problem = null;
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
    setAttribute(this, "data-undelivered", this.#undelivered);
    setText(this.word, { sending: "SENDING", engaged: "ENGAGED", ready: "STOP" }[phase]);
    setAttribute(
      this.button,
      "aria-label",
      { ready: "STOP", sending: "STOP, sending", engaged: "STOP, engaged" }[phase],
    );
    setAttribute(this.release, "hidden", !engaged || this.#sending);
    setText(this.status, this.#statusWords(engaged));
    setText(this.by, phase === "engaged" ? byWords(this.#latch) : "");
    setAttribute(this.standstill, "data-moving", this.#moves);
    setText(this.standstill, phase === "engaged" ? this.#stands : "");
  }

  #statusWords(engaged) {
    if (this.#undelivered) {
      const refused = this.#problem?.status ? ` (${this.#problem.detail})` : "";
      return `Not delivered. Use the hardware stop.${refused} Retrying.`;
    }
    if (this.#sending) return "Sending the stop …";
    if (this.#problem) return `Not released: ${this.#problem.detail}`;
    if (!engaged) return "";
    const { since_at } = this.#latch;
    return `Stop engaged${since_at ? ` at ${timeOfDay(since_at)}` : ""}`;
  }
}

function byWords({ by, reason }) {
  return [by ? `by ${by}` : "", reason ?? ""].filter(Boolean).join(": ");
}

customElements.define("ph-stop-button", StopButton);
