/** <ph-reaction>: what a reaction does and waits for; opened why, and whether it may act.
 *
 * Arming and acknowledging may set the robot in motion, so both need a long press.
 */

import { partPath, request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { showProblem } from "/web/js/base/problem.js";
import { reasonTree } from "/web/js/base/reasons.js";
import { isSame } from "/web/js/base/same.js";
import { whileSending } from "/web/js/base/sending.js";
import { plainMessage } from "/web/js/base/signal_words.js";
import { label, modeName, timeAndDay } from "/web/js/base/words.js";

const ARMS = ["active", "passive", "disarmed"];
const STATES = {
  idle: "waits",
  pending: "is about to act",
  acting: "acts",
  passive: "would act",
  overruled: "is overruled",
  exhausted: "has no attempts left",
};

class Reaction extends HTMLElement {
  #isChosen = false;
  #seen = [];

  connectedCallback() {
    if (this.head) return;
    this.name = el("strong");
    this.state = el("span", { class: "tag" });
    this.does = el("span", { class: "quiet" });
    this.waits = el("span", { class: "reaction-waits" });
    this.head = el("summary", {}, el("span", { class: "reaction-head" }, this.name, this.state, this.does), this.waits);
    this.reasons = el("div");
    this.buttons = this.#makeButtons();
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.details = el("details", { class: "unfold" }, this.head, this.reasons, this.buttons, this.problem);
    this.details.addEventListener("toggle", () => this.#fillWhy());
    this.append(this.details);
  }

  #makeButtons() {
    this.arm = el("select", {}, ...ARMS.map((arm) => el("option", { value: arm }, arm)));
    this.arm.addEventListener("change", () => {
      this.#isChosen = true;
      this.#showSet();
    });
    this.set = el("ph-hold-button", { label: "Set (hold)", hidden: true });
    this.set.addEventListener("ph-held", () => this.#arm());
    this.seen = el("ph-hold-button", { label: "Acknowledge (hold)", hidden: true });
    this.seen.addEventListener("ph-held", ({ detail }) => this.#acknowledge(detail.volatile));
    const armed = el("label", { class: "field inline" }, el("span", { class: "quiet" }, "Arm"), this.arm);
    return el("div", { class: "buttons" }, armed, this.set, this.seen);
  }

  /** Show a reaction named `name`, such as "rover.LIMP". */
  show({ name, reaction, view: { state, enabled, volatile } }) {
    const seen = [reaction, enabled, volatile];
    if (isSame(seen, this.#seen)) return;
    this.#seen = seen;
    this.reaction = reaction;
    this.words = (text) => plainMessage(text, state.signals);
    const part = state.parts[reaction.part] ?? { kind: "node", name: reaction.part };
    this.path = `${partPath(part)}/reactions/${encodeURIComponent(reaction.reaction)}`;
    setAttribute(this, "data-state", reaction.state);
    setText(this.name, name);
    setText(this.state, STATES[reaction.state] ?? reaction.state);
    setText(this.does, doneBy(reaction));
    setText(this.waits, `Waits for ${reaction.waits_for}`);
    this.#fillWhy();
    setAttribute(this.arm, "aria-label", `Arm ${name}`);
    if (!this.#isChosen) this.arm.value = reaction.arm;
    this.arm.disabled = !enabled;
    this.#showSet();
    const isNeeded = needsAcknowledgement(reaction);
    if (isNeeded && this.seen.hidden) this.details.open = true;
    setAttribute(this.seen, "hidden", !isNeeded);
    for (const button of [this.set, this.seen]) {
      button.disabled = !enabled;
      button.volatile = volatile;
    }
  }

  #fillWhy() {
    const { blockers } = this.reaction;
    if (this.details.open) renderOnce(this.reasons, JSON.stringify(blockers), () => (blockers.length ? [reasonTree(blockers, this.words)] : []));
  }

  #showSet() {
    setAttribute(this.set, "hidden", this.arm.value === this.reaction.arm);
  }

  #arm() {
    const arm = this.arm.value;
    return this.#send(this.set, async () => {
      await request("PATCH", this.path, { arm, reason: "set on the page" });
      this.#isChosen = false;
    });
  }

  #acknowledge(volatile) {
    const path = `${this.path}/acknowledge`;
    return this.#send(this.seen, () =>
      request("POST", volatile ? `${path}?volatile=true` : path),
    );
  }

  #send({ button }, act) {
    return whileSending(button, async () => {
      let problem = null;
      try {
        await act();
      } catch (error) {
        if (!error.problem) throw error;
        problem = error.problem;
      }
      showProblem(this.problem, problem);
    });
  }
}

/** "mode SLOW since 14:02:11, 2 left": what it does, and how often it still may. */
function doneBy({ action, target, left, state, since_at: since }) {
  const to = target ? ` ${action === "mode" ? modeName(target.mode) : label(target)}` : "";
  const when = since && state !== "idle" ? ` since ${timeAndDay(since)}` : "";
  const often = left === null ? "" : `, ${left} left`;
  return `${action.replace("_", " ")}${to}${when}${often}`;
}

function needsAcknowledgement({ state, until }) {
  return state === "exhausted" || (until === "acknowledged" && (state === "acting" || state === "passive"));
}

customElements.define("ph-reaction", Reaction);
