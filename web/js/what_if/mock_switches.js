/** What the mock of the running robot publishes: this is live, and no part of the simulation. */

import { el, setAttribute } from "/web/js/base/dom.js";
import { describe } from "/web/js/base/signal_catalog.js";
import "/web/js/what_if/mock_control.js";

export class MockSwitches {
  #controls = new Map();

  constructor() {
    this.list = el("div", { class: "mock-list" });
    this.node = el(
      "details",
      { class: "mock-switches", hidden: true },
      el("summary", {}, "Mock signals of this robot ", el("strong", { class: "live-mark" }, "LIVE")),
      el("p", { class: "quiet" }, "Not simulated: this changes what the running mock publishes."),
      this.list,
    );
  }

  show({ live, mock, enabled }) {
    const names = Object.keys(mock).filter((name) => live.signals[name]);
    setAttribute(this.node, "hidden", names.length === 0);
    for (const name of names) {
      const control = this.#controls.get(name) ?? this.#add(name, live.signals[name]);
      control.show(live.signals[name], mock[name], enabled);
    }
  }

  #add(name, signal) {
    const control = el("ph-mock-control");
    this.#controls.set(name, control);
    this.list.append(control);
    control.open(name, describe(name, signal));
    return control;
  }
}
