/** <ph-lifecycle>: the transitions that a part can make now; folded, since they are rarely needed.
 *
 * Dispatches `ph-ask` with the `{button, what, body}` of a request.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";

const TRANSITIONS = ["configure", "activate", "deactivate", "cleanup", "shutdown"];

class Lifecycle extends HTMLElement {
  connectedCallback() {
    if (this.details) return;
    this.buttons = TRANSITIONS.map((name) => [name, this.#button(name)]);
    this.state = el("span", { class: "quiet" });
    this.details = el(
      "details",
      { class: "fold" },
      el("summary", {}, "Lifecycle ", this.state),
      el("div", { class: "buttons", role: "group", "aria-label": "Lifecycle" }, ...this.buttons.map(([, node]) => node)),
    );
    this.append(this.details);
  }

  /** Without modes to choose from it is the way to change a part, so it begins open. */
  begin(isOpen) {
    this.details.open = isOpen;
  }

  show({ part, transitions, enabled }) {
    setText(this.state, part.actual.state);
    for (const [name, node] of this.buttons) {
      const isOff = !enabled || !transitions.includes(name);
      if (name === "shutdown") node.disabled = isOff;
      else setAttribute(node, "disabled", isOff);
    }
  }

  /** A finalized part cannot be restarted, so shutdown needs a long press. */
  #button(name) {
    const isLast = name === "shutdown";
    const node = isLast
      ? el("ph-hold-button", { label: "shutdown (hold)" })
      : el("button", { type: "button", class: "small" }, name);
    node.addEventListener(isLast ? "ph-held" : "click", () => {
      const detail = { button: node.button ?? node, what: "state", body: { transition: name } };
      this.dispatchEvent(new CustomEvent("ph-ask", { bubbles: true, detail }));
    });
    return node;
  }
}

customElements.define("ph-lifecycle", Lifecycle);
