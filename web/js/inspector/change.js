/** <ph-change>: the progress of the last change, step by step, or why a request was rejected. */

import { request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { problemLines } from "/web/js/base/problem.js";
import { whileSending } from "/web/js/base/sending.js";
import { progressWords, stepLists } from "/web/js/base/step_list.js";
import { changeWords, isOpen, requestWords, timeOfDay, wholeSeconds } from "/web/js/base/words.js";

class Change extends HTMLElement {
  connectedCallback() {
    if (this.result) return;
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.asked = el("h3");
    this.status = el("p", { class: "change-status" });
    this.progress = el("p", { class: "facts" });
    this.steps = el("div", { class: "steps" });
    this.cancel = el(
      "button",
      { type: "button", class: "small", onclick: () => this.#cancel() },
      "Cancel the rest",
    );
    this.result = el(
      "div",
      { class: "change", hidden: true },
      this.asked,
      this.status,
      this.progress,
      this.steps,
      this.cancel,
    );
    this.append(this.problem, this.result);
  }

  show({ part, change, problem, knownAt }) {
    setAttribute(this.problem, "hidden", !problem);
    renderOnce(this.problem, JSON.stringify(problem), () => (problem ? problemLines(problem) : []));
    setAttribute(this.result, "hidden", !change);
    if (!change) return;
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
    const progress = [progressWords(change), deadlineWords(change, knownAt)].filter(Boolean);
    setText(this.progress, progress.join(", "));
    setAttribute(this.cancel, "hidden", !isOpen(change));
    const running = isOpen(change) ? Math.floor(knownAt / 250) : 0;
    renderOnce(this.steps, JSON.stringify([change.steps, running]), () =>
      stepLists(change.steps, knownAt),
    );
    // A press is under way: its mark is a child of the button.
    if (this.cancel.hasAttribute("data-sending")) return;
    setText(this.cancel, change.status === "waiting" ? "Stop waiting" : "Cancel the rest");
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

/** "times out in 12 s", while a change with a deadline runs. */
function deadlineWords(change, now) {
  if (!change.deadline_at || change.status !== "running") return "";
  return `times out in ${wholeSeconds(Math.max(0, Date.parse(change.deadline_at) - now))}`;
}

customElements.define("ph-change", Change);
