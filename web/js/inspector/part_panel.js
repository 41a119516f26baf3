/** <ph-part-panel>: the selected part, its commands, and the progress of the last request. */

import { partPath, request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { isSame } from "/web/js/base/same.js";
import { whileSending } from "/web/js/base/sending.js";
import { errorsOf } from "/web/js/base/store.js";
import "/web/js/inspector/change.js";
import "/web/js/inspector/error_list.js";
import "/web/js/inspector/lifecycle.js";
import "/web/js/inspector/mode_switcher.js";
import "/web/js/inspector/parameters.js";
import "/web/js/inspector/part_device.js";
import { whatDecides, whatIsNamed } from "/web/js/inspector/part_inputs.js";
import { PartScreen } from "/web/js/inspector/part_screen.js";
import { PartWatch, requestPlan } from "/web/js/inspector/part_watch.js";
import "/web/js/inspector/part_why.js";
import "/web/js/inspector/plan.js";
import "/web/js/inspector/reaction_list.js";

/** What decides about a part may change with each frame; nobody reads faster. */
const PAUSE_MS = 200;

class PartPanel extends HTMLElement {
  #inputs = [];
  #lookedAt = -Infinity;

  connectedCallback() {
    this.watch = new PartWatch(() => this.#show());
    this.screen = new PartScreen(() => this.#emit("ph-back"));
    this.#build();
    this.addEventListener("ph-ask", ({ detail }) => this.#ask(detail));
    this.addEventListener("ph-problem", ({ detail }) => this.#refused(detail));
    this.addEventListener("ph-explain", () => this.watch.explain(this.why.isOpen));
    this.addEventListener("ph-apply", ({ detail }) => this.#apply(detail));
    this.addEventListener("ph-close", () => this.#closePlan());
    this.addEventListener("ph-dismissed", () => this.heading.focus());
  }

  #build() {
    this.heading = el("h2", { tabindex: -1 });
    const goBack = () => this.screen.back();
    const back = el("button", { type: "button", class: "small narrow-only", onclick: goBack }, "Back");
    this.kind = el("span", { class: "kind" });
    this.pills = el("ph-pills");
    this.reason = el("p", { class: "note" });
    this.device = el("ph-part-device", { hidden: true });
    this.why = el("ph-part-why", { hidden: true });
    this.errors = el("ph-error-list", { hidden: true });
    this.planFirst = el("input", { type: "checkbox", role: "switch" });
    const planFirst = el("label", { class: "switch" }, this.planFirst, "Plan first");
    this.modeTitle = el("h3", {}, "Mode");
    this.commands = el("ph-mode-switcher");
    this.plan = el("ph-plan", { hidden: true });
    this.result = el("ph-change");
    this.parameters = el("ph-parameters", { hidden: true });
    this.reactions = el("ph-reaction-list", { hidden: true });
    this.lifecycle = el("ph-lifecycle");
    this.empty = el("p", { class: "quiet" }, "Select a part to see and change its mode.");
    this.whole = el(
      "div",
      { hidden: true },
      el("div", { class: "panel-head" }, back, this.heading, this.kind),
      this.pills,
      this.reason,
      this.device,
      this.why,
      this.errors,
      el("div", { class: "mode-head" }, this.modeTitle, planFirst),
      this.commands,
      this.plan,
      this.result,
      this.parameters,
      this.reactions,
      this.lifecycle,
    );
    this.append(this.empty, this.whole);
  }

  /** Reload what the stream does not carry. */
  refresh() {
    this.watch.refresh();
  }

  /** Show the panel where it is out of sight: on a narrow screen in place of the list. */
  bringIntoView() {
    if (this.screen.open()) this.heading.focus({ preventScroll: true });
    else this.scrollIntoView({ block: "nearest" });
  }

  /** Take a frame of the stream, which may hold news of the part and its changes. */
  hear(frame) {
    this.watch.hear(frame);
  }

  update(view) {
    const { state, selected, enabled, moment, knownAt, volatile } = view;
    const part = state.parts[selected];
    const own = [part, enabled, moment, volatile, Math.floor(knownAt / 1000)];
    const { parts, devices, signals, errors, reactions, systemState, task, vehicle, holds } = state;
    const inputs = [...own, parts, devices, signals, errors, reactions, systemState, task, vehicle, holds];
    if (isSame(inputs, this.#inputs)) return;
    const isOwn = !isSame(own, this.#inputs.slice(0, own.length));
    if (!isOwn && performance.now() - this.#lookedAt < PAUSE_MS) return;
    this.#inputs = inputs;
    this.#lookedAt = performance.now();
    this.view = view;
    setAttribute(this.empty, "hidden", Boolean(part));
    setAttribute(this.whole, "hidden", !part);
    if (part) this.#look(part);
  }

  #look(part) {
    const { state, moment } = this.view;
    if (this.watch.part?.name !== part.name && part.kind) {
      this.problem = null;
      this.isBegun = false;
      this.watch.select(part);
    }
    const seen = [...whatDecides(part, state), ...whatIsNamed(this.watch, state)];
    if (!moment && !isSame(seen, this.seen)) this.watch.refresh();
    if (!moment) this.seen = seen;
    setText(this.heading, part.name);
    setText(this.kind, part.kind ?? "");
    this.pills.show(part);
    setText(this.reason, part.actual.reason ?? "");
    this.device.show({ part, device: state.devices[part.device], knownAt: this.view.knownAt });
    this.errors.show({ errors: errorsOf(state, part.name), knownAt: this.view.knownAt });
    this.#showReactions(part);
    this.#show();
  }

  #showReactions({ name }) {
    const of = Object.entries(this.view.state.reactions).filter(([, { part }]) => part === name);
    this.reactions.show({ reactions: Object.fromEntries(of), view: this.view });
  }

  #ask({ button, what, body }) {
    const path = `${partPath(this.watch.part)}/${what}`;
    const isPlanned = this.planFirst.checked && !body.wait_for_s;
    return this.#whileAsking(button, async () => {
      if (isPlanned) this.#planned(await requestPlan({ path, body }));
      else this.#began(await request("POST", path, body));
    });
  }

  #apply(button) {
    const { path, body } = this.watch.plan;
    return this.#whileAsking(button, async () => this.#began(await request("POST", path, body)));
  }

  #whileAsking(button, act) {
    return whileSending(button, async () => {
      try {
        await act();
      } catch (error) {
        if (!error.problem) throw error;
        this.#refused(error.problem);
      }
    });
  }

  #planned(plan) {
    this.problem = null;
    this.watch.plan = plan;
    this.#show();
  }

  #closePlan() {
    this.watch.plan = null;
    this.#show();
    this.planFirst.focus();
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

  #emit(name) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true }));
  }

  /** What was answered is of now: of an earlier moment only what a frame told is shown. */
  #show() {
    const { watch, view } = this;
    if (watch.part === null || !view) return;
    const { moment, enabled, knownAt } = view;
    const { parts, signals } = view.state;
    const part = parts[watch.part.name] ?? watch.part;
    const isNow = moment === null;
    this.why.show({ part, why: isNow ? watch.why : whyThen(part), signals });
    watch.explain(isNow && this.why.isOpen);
    const modes = isNow ? watch.modes : watch.modes.map(withoutReasons);
    setAttribute(this.modeTitle.parentElement, "hidden", modes.length === 0);
    this.planFirst.disabled = !enabled;
    this.commands.show({ part, modes, enabled, isLive: enabled, signals });
    this.plan.show({ plan: isNow ? watch.plan : null, enabled });
    const change = isNow ? watch.change : null;
    this.result.show({ part, change, problem: isNow ? this.problem : null, enabled, knownAt });
    this.parameters.show({ parameters: isNow ? watch.parameters : null });
    this.lifecycle.show({ part, transitions: watch.transitions, enabled });
    this.#begin();
  }

  /** Once it is known what a part has, what is mostly needed is open. */
  #begin() {
    if (this.isBegun || !this.watch.isLoaded) return;
    this.isBegun = true;
    this.lifecycle.begin(this.watch.modes.length === 0);
  }
}

/** A frame tells why a target was displaced, and which part deviates. */
function whyThen({ effective_target: target, deviation_reason: reason }) {
  const blockers = [...(target?.blockers ?? [])];
  if (reason) blockers.push({ message: reason, path: [], causes: [] });
  return { blockers };
}

function withoutReasons({ mode }) {
  return { mode, can_enter: true, can_stay: null, blockers: [] };
}

customElements.define("ph-part-panel", PartPanel);
