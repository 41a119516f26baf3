/** <ph-change>: the progress of the last change, step by step, or why a request was rejected. */

import { request } from "/web/js/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/dom.js";
import { problemLines } from "/web/js/problem.js";
import { whileSending } from "/web/js/sending.js";
import { changeWords, duration, requestWords, timeOfDay } from "/web/js/words.js";

const MARKS = { pending: "·", running: "…", succeeded: "✓", failed: "✕", timed_out: "✕" };

class Change extends HTMLElement {
  connectedCallback() {
    if (this.result) return;
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.asked = el("h3");
    this.status = el("p", { class: "change-status" });
    this.steps = el("ol", { class: "steps" });
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
    setAttribute(this.cancel, "hidden", change.status !== "running");
    const running = change.status === "running" ? Math.floor(knownAt / 250) : 0;
    renderOnce(this.steps, JSON.stringify([change.steps, running]), () =>
      change.steps.map((step) => stepLine(step, knownAt)),
    );
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

function stepLine(step, now) {
  const { node, action, status, started_at, ended_at, error } = step;
  const took = started_at
    ? duration((ended_at ? Date.parse(ended_at) : now) - Date.parse(started_at))
    : "";
  return el(
    "li",
    { "data-status": status },
    el("span", { class: "step-mark", "aria-hidden": "true" }, MARKS[status] ?? "–"),
    el("span", {}, `${node}: ${action.replaceAll("_", " ")}`),
    el("span", { class: "quiet" }, `${status.replaceAll("_", " ")}${took ? `, ${took}` : ""}`),
    error ? el("span", { class: "step-error" }, error) : null,
  );
}

customElements.define("ph-change", Change);
