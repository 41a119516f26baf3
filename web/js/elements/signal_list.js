/** <ph-signal-list> and <ph-signal-card>: each signal with value, age and errors. */

import { el, setAttribute, setText } from "/web/js/dom.js";
import { describe } from "/web/js/signal_catalog.js";
import { duration } from "/web/js/words.js";

class SignalList extends HTMLElement {
  #cards = new Map();

  update(view) {
    for (const [name, signal] of Object.entries(view.state.signals)) {
      if (!this.#cards.has(name)) {
        const card = el("ph-signal-card");
        this.#cards.set(name, card);
        this.append(card);
      }
      this.#cards.get(name).show(name, signal, view);
    }
  }
}

class SignalCard extends HTMLElement {
  connectedCallback() {
    this.name = el("h3");
    this.value = el("span", { class: "value" });
    this.unit = el("span", { class: "unit" });
    this.age = el("span", { class: "age quiet" });
    this.verdict = el("span", { class: "verdict" });
    this.bar = el("progress", { hidden: true });
    this.append(
      el("div", { class: "card-head" }, this.name, this.verdict),
      el("div", { class: "reading" }, el("span", {}, this.value, this.unit), this.age),
      this.bar,
    );
  }

  show(name, signal, { serverNow, contact, mock }) {
    const about = describe(name, signal.unit);
    const seen = signal.value !== null;
    const [value, unit] = seen ? about.show(signal.value) : ["?", ""];
    setText(this.name, about.label);
    setText(this.value, value);
    setText(this.unit, unit);
    setText(this.age, ageWords(signal, serverNow));
    this.#judge(signal, serverNow);
    if (mock[name] && !this.control) {
      this.control = el("ph-mock-control");
      this.append(this.control);
      this.control.open(name, about);
    }
    this.control?.show(signal, mock[name], contact.level !== "lost");
  }

  #judge({ error, stale, pending }, now) {
    const level = error || stale ? "error" : pending ? "pending" : "ok";
    setAttribute(this, "data-level", level);
    setAttribute(this.bar, "hidden", level !== "pending");
    const words = [error, stale && error !== "STALE_DATA" ? "STALE" : null]
      .filter(Boolean)
      .join(", ");
    if (level !== "pending") {
      setText(this.verdict, words ? `⚠ ${words}` : "OK");
      return;
    }
    const done = Math.min((now - Date.parse(pending.since_at)) / 1000, pending.needs_s);
    this.bar.max = pending.needs_s;
    this.bar.value = done;
    setAttribute(this.bar, "aria-label", `${pending.error} is pending`);
    setText(this.verdict, `${pending.error} in ${Math.ceil(pending.needs_s - done)} s`);
  }
}

function ageWords({ received_at, stale }, now) {
  if (!received_at) return "never received";
  const age = now - Date.parse(received_at);
  return age < 1000 && !stale ? "now" : `${duration(age)} old`;
}

customElements.define("ph-signal-list", SignalList);
customElements.define("ph-signal-card", SignalCard);
