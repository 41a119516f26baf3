/** <ph-part-panel>: the selected part, its commands, and the progress of the last request. */

import { request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { PartWatch } from "/web/js/inspector/part_watch.js";
import { conditionsIn } from "/web/js/base/reasons.js";
import { whileSending } from "/web/js/base/sending.js";
import { errorsOf } from "/web/js/base/store.js";

const SPACE_PX = 12;

class PartPanel extends HTMLElement {
  connectedCallback() {
    this.watch = new PartWatch(() => this.#show());
    this.heading = el("h2", { tabindex: -1 });
    this.back = el(
      "button",
      { type: "button", class: "small narrow-only", onclick: () => this.#goBack() },
      "Back to the list",
    );
    this.kind = el("span", { class: "kind" });
    this.pills = el("ph-pills");
    this.reason = el("p", { class: "note" });
    this.why = el("ph-why", { hidden: true });
    this.errors = el("ph-error-list", { hidden: true });
    this.commands = el("ph-mode-switcher");
    this.plan = el("ph-plan", { hidden: true });
    this.result = el("ph-change");
    this.empty = el("p", { class: "quiet" }, "Select a part to see and change its mode.");
    this.whole = el(
      "div",
      { hidden: true },
      el("div", { class: "panel-head" }, this.heading, this.kind, this.back),
      this.pills,
      this.reason,
      this.why,
      this.errors,
      this.commands,
      this.plan,
      this.result,
    );
    this.append(this.empty, this.whole);
    this.addEventListener("ph-change", ({ detail }) => this.#began(detail));
    this.addEventListener("ph-problem", ({ detail }) => this.#refused(detail));
    this.addEventListener("ph-why", () => this.watch.explain(this.why.isOpen));
    this.addEventListener("ph-plan", ({ detail }) => this.#planned(detail));
    this.addEventListener("ph-apply", ({ detail }) => this.#apply(detail));
    this.addEventListener("ph-close", () => this.#closePlan());
  }

  /** Reload what the stream does not carry. */
  refresh() {
    this.watch.refresh();
  }

  /** Scroll to the panel if it is out of view: else a tap far down the list would show nothing. */
  bringIntoView() {
    const header = document.querySelector("header").getBoundingClientRect().bottom;
    const { top } = this.getBoundingClientRect();
    const isNarrow = matchMedia("(max-width: 1023px)").matches;
    if (top >= header && top < innerHeight / 2) return;
    if (!isNarrow) {
      this.scrollIntoView({ block: "nearest" });
      return;
    }
    scrollTo({ top: scrollY + top - header - SPACE_PX });
    this.heading.focus({ preventScroll: true });
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
    const seen = [...whatDecides(part, view.state), ...whatIsNamed(this.watch, view.state)];
    if (!isSame(seen, this.seen)) this.watch.refresh();
    this.seen = seen;
    setText(this.heading, part.name);
    setText(this.kind, part.kind ?? "");
    this.pills.show(part);
    setText(this.reason, part.actual.reason ?? "");
    this.errors.show({ errors: errorsOf(view.state, part.name), knownAt: view.knownAt });
    this.#show();
  }

  #goBack() {
    this.dispatchEvent(new CustomEvent("ph-back", { bubbles: true }));
  }

  #planned(plan) {
    this.problem = null;
    this.watch.plan = plan;
    this.#show();
  }

  #apply(button) {
    const { path, body } = this.watch.plan;
    return whileSending(button, async () => {
      try {
        this.#began(await request("POST", path, body));
      } catch (error) {
        this.#refused(error.problem);
      }
    });
  }

  #closePlan() {
    this.watch.plan = null;
    this.#show();
    this.commands.planFirst.focus();
  }

  #began(change) {
    this.problem = null;
    this.watch.plan = null;
    this.watch.follow(change);
  }

  #refused(problem) {
    this.problem = problem;
    this.watch.refresh();
    this.#show();
  }

  #show() {
    const { part, transitions, modes, change, why, plan } = this.watch;
    if (part === null) return;
    const { state, contact, knownAt } = this.view;
    const now = state.parts[part.name] ?? part;
    const enabled = contact.level !== "lost";
    this.why.show({ part: now, why });
    this.watch.explain(this.why.isOpen);
    this.commands.show({ part: now, transitions, modes, enabled });
    this.plan.show({ plan, enabled });
    this.result.show({ part: now, change, problem: this.problem, knownAt });
  }
}

/** What blockers are made of: the part and all below it, the errors with their reasons, the stop.
 *
 * Parts that a frame leaves out stay the same objects, so this is cheap to compare.
 */
function whatDecides(part, { parts, systemState, errors, emergencyStop }) {
  const reasons = (systemState?.reasons ?? []).map(({ code, message }) => `${code}: ${message}`);
  const below = new Set();
  const add = (one) => {
    if (!one || below.has(one)) return;
    below.add(one);
    for (const name of one.parts ?? []) add(parts[name]);
  };
  add(part);
  return [...below, errors, reasons.join("\n"), Boolean(emergencyStop?.engaged)];
}

/** The facts that the conditions of the modes name: readings and parts anywhere, the drive. */
function whatIsNamed({ modes, why }, { signals, parts, task, vehicle, holds }) {
  const blockers = [...modes.flatMap((mode) => mode.blockers), ...(why?.blockers ?? [])];
  const guards = modes.flatMap(({ requires = [], invariants = [] }) => [...requires, ...invariants]);
  const text = [...guards, ...conditionsIn(blockers)].join("\n");
  if (!text) return [];
  const named = (members) =>
    Object.values(members).filter((one) => text.includes(one.signal ?? one.name));
  return [
    ...named(signals).flatMap(({ value, stale, error }) => [value, stale, error]),
    ...named(parts),
    ...(text.includes("task.") ? [task] : []),
    ...(text.includes("vehicle.") ? [vehicle] : []),
    ...(text.includes("hold") ? [holds] : []),
  ];
}

function isSame(one, other) {
  return one.length === other?.length && one.every((item, index) => item === other[index]);
}

customElements.define("ph-part-panel", PartPanel);
