/** <ph-part-panel>: the selected part, its commands, and the progress of the last request. */

import { el, setAttribute, setText } from "/web/js/dom.js";
import { PartWatch } from "/web/js/part_watch.js";

class PartPanel extends HTMLElement {
  connectedCallback() {
    this.watch = new PartWatch(() => this.#show());
    this.heading = el("h2");
    this.kind = el("span", { class: "kind" });
    this.pills = el("ph-pills");
    this.reason = el("p", { class: "note" });
    this.commands = el("ph-mode-switcher");
    this.result = el("ph-change");
    this.empty = el("p", { class: "quiet" }, "Select a part to see and change its mode.");
    this.whole = el(
      "div",
      { hidden: true },
      el("div", { class: "panel-head" }, this.heading, this.kind),
      this.pills,
      this.reason,
      this.commands,
      this.result,
    );
    this.append(this.empty, this.whole);
    this.addEventListener("ph-change", ({ detail }) => this.#began(detail));
    this.addEventListener("ph-problem", ({ detail }) => this.#refused(detail));
  }

  /** Reload what the stream does not carry. */
  refresh() {
    this.watch.refresh();
  }

  /** Take a frame of the stream, which may hold news of the part and its changes. */
  hear(frame) {
    this.watch.hear(frame);
  }

  update(view) {
    this.view = view;
    const part = view.state.parts[view.selected];
    setAttribute(this.empty, "hidden", Boolean(part));
    setAttribute(this.whole, "hidden", !part);
    if (!part) return;
    if (this.watch.part?.name !== part.name && part.kind) {
      this.problem = null;
      this.watch.select(part);
    }
    const seen = JSON.stringify([part, view.state.systemState?.errors]);
    if (this.seen !== seen) this.watch.refresh();
    this.seen = seen;
    setText(this.heading, part.name);
    setText(this.kind, part.kind ?? "");
    this.pills.show(part);
    setText(this.reason, part.actual.reason ?? "");
    this.#show();
  }

  #began(change) {
    this.problem = null;
    this.watch.follow(change);
  }

  #refused(problem) {
    this.problem = problem;
    this.watch.refresh();
    this.#show();
  }

  #show() {
    const { part, transitions, modes, change } = this.watch;
    if (part === null) return;
    const { state, contact, knownAt } = this.view;
    const now = state.parts[part.name] ?? part;
    this.commands.show({ part: now, transitions, modes, enabled: contact.level !== "lost" });
    this.result.show({ part: now, change, problem: this.problem, knownAt });
  }
}

customElements.define("ph-part-panel", PartPanel);
