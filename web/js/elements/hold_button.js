/** <ph-hold-button label="...">: dispatches `ph-held` after a press of 1.5 s, by pointer or key. */

import { el, setAttribute } from "/web/js/dom.js";

const HOLD_MS = 1500;

class HoldButton extends HTMLElement {
  connectedCallback() {
    if (this.button) return;
    const label = this.getAttribute("label");
    this.button = el(
      "button",
      { type: "button" },
      el("span", { class: "fill" }),
      el("span", {}, label),
    );
    this.append(this.button);
    this.button.addEventListener("pointerdown", () => this.#start());
    for (const end of ["pointerup", "pointerleave", "pointercancel", "blur", "keyup"]) {
      this.button.addEventListener(end, () => this.#cancel());
    }
    this.button.addEventListener("keydown", (event) => {
      if (event.key !== " " && event.key !== "Enter") return;
      event.preventDefault();
      if (!event.repeat) this.#start();
    });
    this.button.addEventListener("contextmenu", (event) => event.preventDefault());
  }

  disconnectedCallback() {
    this.#cancel();
  }

  set disabled(value) {
    setAttribute(this.button, "disabled", value);
    if (value) this.#cancel();
  }

  #start() {
    this.#cancel();
    setAttribute(this, "holding", true);
    this.timer = setTimeout(() => {
      this.#cancel();
      this.dispatchEvent(new CustomEvent("ph-held", { bubbles: true }));
    }, HOLD_MS);
  }

  #cancel() {
    clearTimeout(this.timer);
    setAttribute(this, "holding", false);
  }
}

customElements.define("ph-hold-button", HoldButton);
