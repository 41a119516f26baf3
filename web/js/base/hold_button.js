/** <ph-hold-button label="..." short="...">: dispatches `ph-held` after a press of 1 s, by pointer or
 * key. Where there is little room, `short` is what is seen of the label.
 *
 * Screen readers and switches can only click: for them a second click within 5 s confirms.
 *
 * While it is `volatile`, its label says that a restart may forget what it does. The event has
 * `{volatile}`: whether it said so when the press began.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";

const HOLD_MS = 1000;
const AWAY_PX = 32;
const TOLD_MS = 2500;
const CONFIRM_MS = 5000;

class HoldButton extends HTMLElement {
  #label = "";
  #short = null;
  #volatile = false;
  #consent = false;
  #timer = null;
  #pressedAt = 0;
  #clearing = null;
  #clickedAt = -Infinity;

  connectedCallback() {
    if (this.button) return;
    this.#label = this.getAttribute("label") ?? "";
    this.#short = this.getAttribute("short");
    this.text = el("span", {}, this.#short ?? this.#label);
    this.told = el("span", { class: "visually-hidden", role: "status" });
    this.button = el(
      "button",
      { type: "button", title: "Press and hold for 1 s", "aria-label": this.#short && this.#label },
      el("span", { class: "fill" }),
      this.text,
    );
    this.append(this.button, this.told);
    this.#listen();
  }

  disconnectedCallback() {
    this.#end();
  }

  set label(text) {
    this.#label = text;
    this.#showLabel();
  }

  set volatile(value) {
    if (value === this.#volatile) return;
    this.#volatile = value;
    this.#showLabel();
  }

  get #words() {
    return this.#volatile ? `${this.#label}; a restart may forget it` : this.#label;
  }

  #showLabel() {
    if (this.#clearing === null) this.#seen(this.#words);
  }

  set disabled(value) {
    setAttribute(this.button, "disabled", value);
    if (value) this.#end();
  }

  #listen() {
    const { button } = this;
    button.addEventListener("pointerdown", ({ button: which, pointerId, timeStamp }) => {
      if (which !== 0) return;
      // What is above may grow meanwhile: the press goes on where the button moves from under it.
      if (pointerId) button.setPointerCapture(pointerId);
      this.#start(timeStamp);
    });
    button.addEventListener("pointermove", (event) => isBeside(button, event) && this.#letGo());
    for (const end of ["pointercancel", "blur"]) button.addEventListener(end, () => this.#letGo());
    for (const end of ["pointerup", "keyup"]) {
      button.addEventListener(end, ({ timeStamp }) => this.#release(timeStamp));
    }
    for (const kind of ["keydown", "keyup"]) {
      button.addEventListener(kind, (event) => {
        if (event.key !== " " && event.key !== "Enter") return;
        event.preventDefault();
        if (kind === "keydown" && !event.repeat) this.#start(event.timeStamp);
      });
    }
    button.addEventListener("click", (event) => this.#click(event));
    button.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  #start(at) {
    this.#end();
    this.#pressedAt = at;
    setAttribute(this, "holding", true);
    this.#consent = this.#volatile;
    this.#timer = setTimeout(() => this.#held(), HOLD_MS);
  }

  #held() {
    this.#end();
    this.#say(null);
    const detail = { volatile: this.#consent };
    this.dispatchEvent(new CustomEvent("ph-held", { bubbles: true, detail }));
  }

  /** The time of the press counts, not when a busy page came to it. */
  #release(at) {
    if (this.#timer !== null && at - this.#pressedAt >= HOLD_MS) this.#held();
    else this.#letGo();
  }

  #letGo() {
    if (this.#timer === null) return;
    this.#end();
    this.#say(this.#short === null ? "Keep it pressed for 1 s" : "Keep pressed", TOLD_MS);
  }

  #end() {
    clearTimeout(this.#timer);
    this.#timer = null;
    setAttribute(this, "holding", false);
  }

  /** A click that no pointer made: what pointer and keys do is handled before it. */
  #click({ detail, pointerType }) {
    if (detail > 0 || pointerType) return;
    const isSecond = performance.now() - this.#clickedAt < CONFIRM_MS;
    this.#clickedAt = isSecond ? -Infinity : performance.now();
    if (isSecond) {
      this.#held();
      return;
    }
    this.#consent = this.#volatile;
    this.#say(`${this.#words}: press again to confirm`, CONFIRM_MS);
  }

  /** Say something in place of the label for a while; null: the label. */
  #say(text, forMs) {
    clearTimeout(this.#clearing);
    this.#clearing = text === null ? null : setTimeout(() => this.#say(null), forMs);
    this.#seen(text ?? this.#words);
    setText(this.told, text ?? "");
  }

  #seen(text) {
    if (this.#short === null) {
      setText(this.text, text);
      return;
    }
    const isLabel = text === this.#words;
    setText(this.text, isLabel ? `${this.#short}${this.#volatile ? "; may be forgotten" : ""}` : text);
    setAttribute(this.button, "aria-label", text);
  }
}

/** Whether a pointer was moved away from a button, and not only a little. */
function isBeside(button, { clientX, clientY }) {
  const { left, right, top, bottom } = button.getBoundingClientRect();
  const [x, y] = [Math.max(left - clientX, clientX - right), Math.max(top - clientY, clientY - bottom)];
  return Math.max(x, y) > AWAY_PX;
}

customElements.define("ph-hold-button", HoldButton);
