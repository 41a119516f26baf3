/** The signals of a scenario: a slider for each that is not computed, and which of them are set. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { describe, valueText } from "/web/js/base/signal_catalog.js";
import { makeInput } from "/web/js/what_if/control.js";

const FILTER_FROM = 9;

/** Calls `changed` when the operator has set a signal, or left it as it is. */
export class SignalInputs {
  #rows = new Map();

  constructor(changed) {
    this.changed = changed;
    /** What is set, by the names of signals. */
    this.values = new Map();
    this.filter = el("input", {
      type: "search",
      hidden: true,
      placeholder: "Filter signals",
      "aria-label": "Filter the signals of the simulation",
      oninput: () => this.#sift(),
    });
    this.list = el("div", { class: "what-if-signals" });
    this.empty = el("p", { class: "quiet", hidden: true }, "This robot has no signals that can be set.");
    this.node = el("div", {}, this.filter, this.list, this.empty);
  }

  /** Show the values of the live robot, from which each signal begins. */
  show(signals) {
    for (const [name, signal] of Object.entries(signals)) {
      if (signal.settings.of) continue;
      const row = this.#rows.get(name) ?? this.#add(name, signal);
      row.show(signal);
    }
    setAttribute(this.filter, "hidden", this.#rows.size < FILTER_FROM);
    setAttribute(this.empty, "hidden", this.#rows.size > 0);
  }

  clear() {
    for (const name of [...this.values.keys()]) this.#rows.get(name).leave();
  }

  #add(name, signal) {
    const { label, control } = describe(name, signal);
    const input = makeInput(control, `Simulated ${label}`);
    const live = el("span", { class: "quiet" });
    const leave = el("button", { class: "small", hidden: true, "aria-label": `Leave ${label} as it is` }, "×");
    const head = el("span", { class: "what-if-label", title: label }, label);
    const node = el("div", { class: "what-if-signal" }, head, live, leave, input.node);
    const row = {
      node,
      label,
      show: (now) => {
        const isSet = this.values.has(name);
        const was = valueText(name, now, now.value);
        setText(live, isSet ? `${valueText(name, now, this.values.get(name))} (live ${was})` : was);
        setAttribute(node, "data-set", isSet);
        setAttribute(leave, "hidden", !isSet);
        if (!isSet && now.value !== null) input.write(now.value);
        row.signal = now;
      },
      leave: () => {
        this.values.delete(name);
        row.show(row.signal);
      },
    };
    input.field.addEventListener("input", () => {
      this.values.set(name, input.read());
      row.show(row.signal);
      this.changed();
    });
    leave.addEventListener("click", () => {
      row.leave();
      this.changed();
    });
    this.#rows.set(name, row);
    this.list.append(node);
    return row;
  }

  #sift() {
    const wanted = this.filter.value.trim().toLowerCase();
    for (const [name, { node, label }] of this.#rows)
      setAttribute(node, "hidden", !`${name} ${label}`.toLowerCase().includes(wanted));
  }
}
