/** <ph-plan>: the steps that a request would take now, with a button that sends it.
 *
 * Dispatches `ph-apply`, and `ph-close` when it is to be forgotten.
 */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { areMany, notableSteps, stepLists } from "/web/js/base/step_list.js";
import { duration, requestWords } from "/web/js/base/words.js";

class Plan extends HTMLElement {
  connectedCallback() {
    if (this.heading) return;
    this.heading = el("h3", { tabindex: -1 });
    this.sum = el("p", { class: "change-status" });
    this.steps = el("div", { class: "steps" });
    this.apply = this.#button("Apply", "ph-apply", "primary");
    const buttons = el("div", { class: "buttons" }, this.apply, this.#button("Close", "ph-close"));
    this.append(this.heading, this.sum, this.steps, buttons);
  }

  /** Show a plan, or nothing for null; a plan that was not there before gets the focus. */
  show({ plan, enabled }) {
    const isNew = plan && this.hidden;
    setAttribute(this, "hidden", !plan);
    if (!plan) return;
    setText(this.heading, `Plan: ${requestWords(plan.request)} of ${plan.part}, not requested yet`);
    setText(this.sum, planWords(plan));
    setAttribute(this.apply, "disabled", !enabled);
    renderOnce(this.steps, JSON.stringify(plan.steps), () =>
      areMany(plan.steps) ? notableSteps(plan.steps, 0) : stepLists(plan.steps, 0),
    );
    if (!isNew) return;
    this.heading.focus({ preventScroll: true });
    this.heading.scrollIntoView({ block: "center" });
  }

  #button(text, name, kind) {
    const button = el("button", { type: "button", class: kind ?? null }, text);
    button.addEventListener("click", () =>
      this.dispatchEvent(new CustomEvent(name, { bubbles: true, detail: button })),
    );
    return button;
  }
}

/** "2 stages, about 1.2 s". */
function planWords({ steps, stages, expected_s }) {
  if (steps.length === 0) return "No steps: it is there already";
  const counted = stages === 1 ? "1 stage" : `${stages} stages`;
  const unknown = "how long is not known: a step was never done before";
  return `${counted}, ${expected_s === null ? unknown : `about ${duration(expected_s * 1000)}`}`;
}

customElements.define("ph-plan", Plan);
