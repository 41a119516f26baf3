/** <ph-task-panel>: the current task and its commands, or how the last one ended.
 *
 * The form for a new task is folded away while there is one.
 */

import { request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { problemLines } from "/web/js/base/problem.js";
import { whileSending } from "/web/js/base/sending.js";
import { currentTask } from "/web/js/base/store.js";
import * as words from "/web/js/base/task_words.js";
import { timeOfDay } from "/web/js/base/words.js";

const OPERATOR = "operator";
/** The holds that a press of Resume releases: its own, and that of a task over a restart. */
const RESUMED = [OPERATOR, "restart"];

class TaskPanel extends HTMLElement {
  connectedCallback() {
    this.status = el("strong", { class: "task-status" });
    this.name = el("span", { class: "quiet" });
    this.bar = el("progress", { max: 1, "aria-label": "Progress" });
    this.way = el("p", { class: "task-way" });
    this.point = el("p", { class: "quiet" });
    this.facts = el("p", { class: "quiet" });
    this.reason = el("p", { class: "note" });
    this.pause = el("button", { type: "button", onclick: () => this.#pause() }, "Pause");
    this.resume = el("ph-hold-button", {
      label: "Resume (hold)",
      "onph-held": ({ detail: { volatile } }) =>
        this.#release({ owner: this.resumed, button: this.resume.button, volatile }),
    });
    this.cancel = el("ph-hold-button", {
      label: "Cancel (hold)",
      "onph-held": () => this.#ask(this.cancel.button, "DELETE", "/tasks/current"),
    });
    this.current = el(
      "div",
      { hidden: true },
      el("div", { class: "panel-head" }, this.status, this.name),
      this.bar,
      this.way,
      this.point,
      this.facts,
      this.reason,
      el("div", { class: "buttons task-buttons" }, this.pause, this.resume, this.cancel),
    );
    this.last = el("p", { class: "task-end", role: "status" });
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.holds = el("ph-hold-list", {
      "onph-release": ({ detail }) => this.#release(detail),
    });
    this.form = el("ph-task-form");
    this.fold = el("details", { class: "new-task" }, el("summary", {}, "New task"), this.form);
    this.append(this.current, this.last, this.problem, this.holds, this.fold);
    this.addEventListener("ph-file", () => (this.fold.open = true));
  }

  /** The path trackers that a task may name. */
  set controllers(names) {
    this.form.controllers = names;
  }

  /** The tracks that come with the service, or none. */
  set tracks(items) {
    this.form.tracks = items;
  }

  update({ state, contact, knownAt, volatile }) {
    const { vehicle } = state;
    const task = currentTask(state);
    const holds = Object.values(state.holds);
    const enabled = contact.level !== "lost";
    setAttribute(this.current, "hidden", task === null);
    if (task) this.#show(task, holds, state, enabled);
    const ended = task ? null : state.task;
    setText(this.last, ended ? words.endWords(ended) : "");
    setAttribute(this.last, "data-status", ended?.status);
    this.resume.volatile = volatile;
    this.holds.show({ holds, enabled, knownAt, volatile });
    this.#foldForm(task);
    this.form.show({ task, vehicle, enabled });
  }

  #show(task, holds, { vehicle, at }, enabled) {
    const { id, status, controller, progress, distance_m, length_m } = task;
    setText(this.status, words.TASK_STATUS[status]);
    const then = enabled ? "" : `, as of ${timeOfDay(at)}`;
    setText(this.name, `task ${id}, ${words.controllerName(controller)}${then}`);
    this.bar.value = progress;
    const of = `${words.metres(distance_m)} of ${words.metres(length_m)}`;
    setText(this.way, `${words.percent(progress)}, ${of}`);
    setText(this.point, words.waypointWords(task).replace("w", "W"));
    setText(this.facts, words.driveWords(task, vehicle));
    // The list of holds says the same at more length.
    setText(this.reason, holds.length === 0 ? (task.reason ?? "") : "");
    this.resumed = RESUMED.find((name) => holds.some(({ owner }) => owner === name));
    setAttribute(this.pause, "hidden", Boolean(this.resumed));
    setAttribute(this.resume, "hidden", !this.resumed);
    for (const button of [this.pause, this.resume, this.cancel]) button.disabled = !enabled;
  }

  /** Folded when a task starts and unfolded when it ends; in between the user decides. */
  #foldForm(task) {
    const id = task?.id ?? null;
    if (this.shown === id) return;
    this.shown = id;
    this.fold.open = id === null;
    renderOnce(this.problem, "", () => []);
    setAttribute(this.problem, "hidden", true);
  }

  #pause() {
    this.#ask(this.pause, "PUT", `/holds/${OPERATOR}`, { reason: "paused on the page" });
  }

  #release({ owner, button, volatile }) {
    const path = `/holds/${encodeURIComponent(owner)}`;
    this.#ask(button, "DELETE", volatile ? `${path}?volatile=true` : path);
  }

  #ask(button, method, path, body) {
    return whileSending(button, async () => {
      let problem = null;
      try {
        await request(method, path, body);
      } catch (error) {
        ({ problem } = error);
      }
      renderOnce(this.problem, JSON.stringify(problem), () => (problem ? problemLines(problem) : []));
      setAttribute(this.problem, "hidden", problem === null);
    });
  }
}

customElements.define("ph-task-panel", TaskPanel);
