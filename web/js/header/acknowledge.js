/** <ph-acknowledge>: a button for each error that ends only after somebody acknowledged it.
 *
 * A held task goes on when its last error ends, so this needs a long press.
 */

import { request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";

class Acknowledge extends HTMLElement {
  #buttons = new Map();

  connectedCallback() {
    if (this.problem) return;
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.list = el("div", { class: "buttons" });
    this.append(this.list, this.problem);
  }

  show({ signals, enabled, volatile }) {
    const waiting = Object.values(signals).filter((signal) => signal.needs_acknowledgement);
    const errors = new Set(waiting.map(({ error }) => error));
    setAttribute(this, "hidden", errors.size === 0);
    for (const [error, button] of this.#buttons) {
      if (errors.has(error)) continue;
      button.remove();
      this.#buttons.delete(error);
    }
    for (const error of errors) {
      if (!this.#buttons.has(error)) this.#add(error);
      const button = this.#buttons.get(error);
      button.disabled = !enabled;
      button.volatile = volatile;
    }
  }

  #add(error) {
    const button = el("ph-hold-button", { label: `Acknowledge ${error} (hold)` });
    button.addEventListener("ph-held", ({ detail }) => {
      this.#acknowledge(error, button, detail.volatile);
    });
    this.#buttons.set(error, button);
    this.list.append(button);
  }

  #acknowledge(error, { button }, volatile) {
    return whileSending(button, async () => {
      let said = "";
      try {
        const path = `/errors/${encodeURIComponent(error)}/acknowledge`;
        await request("POST", volatile ? `${path}?volatile=true` : path);
      } catch ({ message }) {
        said = `Not acknowledged: ${message}`;
      }
      setText(this.problem, said);
      setAttribute(this.problem, "hidden", said === "");
    });
  }
}

customElements.define("ph-acknowledge", Acknowledge);
