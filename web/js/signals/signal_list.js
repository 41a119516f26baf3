/** <ph-signal-list> and <ph-signal-card>: each signal with value, age and errors. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { describe } from "/web/js/base/signal_catalog.js";
import { ageWords, pendingFor, valueWords, verdict } from "/web/js/base/signal_words.js";

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

  show(name, signal, { state, serverNow, contact, mock }) {
    const isLive = contact.level !== "lost";
    const [value, unit] = valueWords(name, signal, state.emergencyStop);
    setText(this.name, describe(name, signal.unit).label);
    setText(this.value, value);
    setText(this.unit, unit);
    setText(this.age, ageWords(signal, isLive, serverNow));
    this.#judge(signal, isLive, serverNow);
    if (mock[name] && !this.control) {
      this.control = el("ph-mock-control");
      this.append(this.control);
      this.control.open(name, describe(name, signal.unit));
    }
    this.control?.show(signal, mock[name], isLive);
  }

  #judge(signal, isLive, now) {
    const { level, text } = verdict(signal, isLive, now);
    setAttribute(this, "data-level", level);
    setText(this.verdict, text);
    setAttribute(this.bar, "hidden", level !== "pending");
    if (level !== "pending") return;
    this.bar.max = signal.pending.needs_s;
    this.bar.value = pendingFor(signal.pending, now);
    setAttribute(this.bar, "aria-label", `${signal.pending.error} is pending`);
  }
}

customElements.define("ph-signal-list", SignalList);
customElements.define("ph-signal-card", SignalCard);
