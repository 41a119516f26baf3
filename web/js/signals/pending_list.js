/** <ph-pending-list>: the errors of signals that are about to come, for where signals are not seen. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { describe } from "/web/js/base/signal_catalog.js";
import { pendingFor, verdict } from "/web/js/base/signal_words.js";

class PendingList extends HTMLElement {
  #lines = new Map();

  connectedCallback() {
    this.list = el("ul", { class: "pending", "aria-label": "Pending" });
    this.append(el("h2", {}, "Pending"), this.list);
  }

  update({ state, contact, serverNow }) {
    const pending = Object.entries(state.signals).filter(([, signal]) => signal.pending);
    setAttribute(this.closest("section"), "hidden", pending.length === 0);
    const names = new Set(pending.map(([name]) => name));
    for (const [name, line] of this.#lines) {
      if (names.has(name)) continue;
      line.item.remove();
      this.#lines.delete(name);
    }
    for (const [name, signal] of pending) {
      if (!this.#lines.has(name)) this.#add(name, signal);
      const { ring, text } = this.#lines.get(name);
      const share = pendingFor(signal.pending, serverNow) / signal.pending.needs_s;
      ring.style.setProperty("--share", Math.round(share * 100));
      setText(text, verdict(signal, contact.level !== "lost", serverNow).text);
    }
  }

  #add(name, signal) {
    const [ring, text] = [el("span", { class: "ring" }), el("span", { class: "quiet" })];
    const item = el("li", {}, ring, el("strong", {}, describe(name, signal).label), text);
    this.list.append(item);
    this.#lines.set(name, { item, ring, text });
  }
}

customElements.define("ph-pending-list", PendingList);
