/** <ph-change>: the progress of the last change, step by step, or why a request was rejected.
 *
 * The end of a change stays until it is dismissed.
 */

import { request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { showProblem } from "/web/js/base/problem.js";
import { whileSending } from "/web/js/base/sending.js";
import { areMany, notableSteps, progressWords, stepLists } from "/web/js/base/step_list.js";
import { changeWords, isOpen, requestWords, timeOfDay, wholeSeconds } from "/web/js/base/words.js";

class Change extends HTMLElement {
  #dismissed = new Set();

  connectedCallback() {
    if (this.result) return;
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.asked = el("h3");
    this.status = el("p", { class: "change-status", role: "status" });
    this.progress = el("p", { class: "facts" });
    this.bar = el("progress", { hidden: true, "aria-label": "Steps that are done" });
    this.steps = el("div", { class: "steps" });
    this.details = el("details", { class: "unfold" }, el("summary", {}, "Steps"), this.steps);
    this.cancel = el(
      "button",
      { type: "button", class: "small", onclick: () => this.#cancel() },
      "Cancel the rest",
    );
    const dismiss = () => this.#dismiss();
    this.dismiss = el("button", { type: "button", class: "small", onclick: dismiss }, "Dismiss");
    const head = el("div", { class: "change-head" }, this.asked, this.cancel, this.dismiss);
    const parts = [head, this.status, this.progress, this.bar, this.details];
    this.result = el("div", { class: "change", hidden: true }, ...parts);
    this.append(this.problem, this.result);
  }

  show({ part, change, problem, enabled, knownAt }) {
    showProblem(this.problem, problem);
    const isShown = change && !this.#dismissed.has(nameOf(change));
    setAttribute(this.result, "hidden", !isShown);
    if (!isShown) return;
    const isNew = this.change?.id !== change.id || this.change.status !== change.status;
    this.change = change;
    const of = change.part === part.name ? "" : ` of ${change.part}`;
    setText(
      this.asked,
      `${requestWords(change.request)}${of}, requested at ${timeOfDay(change.started_at)}`,
    );
    setText(
      this.status,
      changeWords(change, knownAt) + (change.reason ? `: ${change.reason}` : ""),
    );
    setAttribute(this.status, "data-status", change.status);
    this.#showSteps(change, knownAt);
    // Once all went well nobody reads the steps.
    if (isNew) this.details.open = change.status !== "succeeded";
    this.#showButtons(change, enabled);
  }

  #showSteps(change, knownAt) {
    const { steps } = change;
    const progress = [progressWords(change), deadlineWords(change, knownAt)].filter(Boolean);
    setText(this.progress, progress.join(", "));
    setAttribute(this.bar, "hidden", !isOpen(change) || steps.length < 2);
    this.bar.max = Math.max(1, steps.length);
    this.bar.value = steps.filter(({ status }) => status === "succeeded").length;
    setAttribute(this.details, "hidden", steps.length === 0);
    const running = isOpen(change) ? Math.floor(knownAt / 250) : 0;
    renderOnce(this.steps, JSON.stringify([steps, running]), () =>
      areMany(steps) ? notableSteps(steps, knownAt) : stepLists(steps, knownAt),
    );
  }

  #showButtons(change, enabled) {
    setAttribute(this.cancel, "hidden", !isOpen(change));
    setAttribute(this.cancel, "disabled", !enabled);
    setAttribute(this.dismiss, "hidden", isOpen(change));
    // A press is under way: its mark is a child of the button.
    if (this.cancel.hasAttribute("data-sending")) return;
    setText(this.cancel, change.status === "waiting" ? "Stop waiting" : "Cancel the rest");
  }

  #dismiss() {
    this.#dismissed.add(nameOf(this.change));
    setAttribute(this.result, "hidden", true);
    this.dispatchEvent(new CustomEvent("ph-dismissed", { bubbles: true }));
  }

  #cancel() {
    return whileSending(this.cancel, async () => {
      try {
        await request("DELETE", `/changes/${this.change.id}`);
      } catch (error) {
        this.dispatchEvent(new CustomEvent("ph-problem", { bubbles: true, detail: error.problem }));
      }
    });
  }
}

/** Ids begin again when nothing was kept over a restart. */
function nameOf({ id, started_at }) {
  return `${id} ${started_at}`;
}

/** "times out in 12 s", while a change with a deadline runs. */
function deadlineWords(change, now) {
  if (!change.deadline_at || change.status !== "running") return "";
  return `times out in ${wholeSeconds(Math.max(0, Date.parse(change.deadline_at) - now))}`;
}

customElements.define("ph-change", Change);
