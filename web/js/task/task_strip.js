/** <ph-task-strip>: the current task in one line, with its commands, or how the last one ended.
 *
 * A new task is made in a sheet beside it, which is loaded when it is asked for.
 */

import { request } from "/web/js/base/api.js";
import { el, icon, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { problemLines } from "/web/js/base/problem.js";
import { whileSending } from "/web/js/base/sending.js";
import { currentTask } from "/web/js/base/store.js";
import { endWords } from "/web/js/base/task_words.js";
import { timeOfDay } from "/web/js/base/words.js";
import { listenForFiles } from "/web/js/task/file_drop.js";
import { heldWords, holdWords, spokenWords, stripWords } from "/web/js/task/strip_words.js";

const OPERATOR = "operator";
/** The holds that a press of Resume releases: its own, and that of a task over a restart. */
const RESUMED = [OPERATOR, "restart"];
const NOT_LOADED = { title: "No answer", status: 0, detail: "The form could not be loaded. Try again." };

class TaskStrip extends HTMLElement {
  #seen = [];
  #view = null;

  connectedCallback() {
    this.symbol = el("span", { class: "task-symbol" });
    this.word = el("strong", { class: "task-word" });
    this.name = el("span", { class: "quiet task-name" });
    this.way = el("span", { class: "task-way" });
    this.more = el("span", { class: "quiet" });
    this.bar = el("progress", { max: 1, "aria-label": "Progress" });
    this.readings = el("dl", { class: "readings" });
    this.told = el("p", { class: "visually-hidden", role: "status" });
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.append(
      el("p", { class: "task-status" }, this.symbol, this.word, this.name),
      el("div", { class: "task-middle" }, el("p", {}, this.way, this.more), this.bar),
      this.readings,
      this.#buttons(),
      this.problem,
      this.told,
    );
    listenForFiles((file) => this.#view?.enabled && this.#open(file));
  }

  #buttons() {
    this.pause = el("button", { type: "button", onclick: () => this.#pause() }, "Pause");
    this.resume = el("ph-hold-button", {
      label: "Resume (hold)",
      "onph-held": ({ detail: { volatile } }) => this.#resume(volatile),
    });
    this.cancel = el("ph-hold-button", {
      label: "Cancel (hold)",
      "onph-held": () => this.#ask(this.cancel.button, "DELETE", "/tasks/current"),
    });
    const fresh = { class: "new-task", "aria-label": "New task", "aria-expanded": "false" };
    this.fresh = el(
      "button",
      { type: "button", title: "New task", onclick: () => this.#toggle(), ...fresh },
      el("span", { class: "long" }, "New task"),
      el("span", { class: "short" }, "+"),
    );
    return el("div", { class: "task-buttons" }, this.pause, this.resume, this.cancel, this.fresh);
  }

  update(view) {
    const { state, enabled, volatile, contact, serverNow } = view;
    this.#view = view;
    const minute = Math.floor(serverNow / 60_000);
    const inputs = [state.task, state.holds, state.vehicle, state.systemState, enabled, volatile];
    inputs.push(contact.level, minute);
    if (inputs.every((input, index) => input === this.#seen[index])) return;
    this.#seen = inputs;
    this.#show(view);
    this.sheet?.show(view);
  }

  #show({ state, enabled, volatile, contact, serverNow }) {
    const task = currentTask(state);
    const holds = Object.values(state.holds);
    const words = stripWords(state, { at: serverNow });
    setAttribute(this, "data-status", state.task?.status ?? "NONE");
    setAttribute(this, "data-current", task !== null);
    renderOnce(this.symbol, words.symbol, () => [icon(words.symbol)]);
    setText(this.word, words.word);
    const then = contact.level === "lost" && state.at ? `as of ${timeOfDay(state.at)}` : null;
    setText(this.name, then ?? words.name);
    setAttribute(this.name, "title", words.controller);
    const held = task ? heldWords(holds) || (task.reason ?? "") : "";
    setText(this.way, held || words.way);
    setText(this.more, words.more);
    const ended = state.task?.ended_at ? endWords(state.task) : "";
    setAttribute(this.way, "title", holds.map(holdWords).join("\n") || ended || null);
    setAttribute(this.bar, "hidden", task === null);
    if (task) this.bar.value = task.progress;
    this.#showReadings(words.readings);
    this.resumed = RESUMED.find((name) => holds.some(({ owner }) => owner === name));
    this.#showButtons(task, enabled, volatile);
    setText(this.told, ended || (task ? spokenWords(task) : ""));
  }

  /** The cells stay while their names do, so that only figures change. */
  #showReadings(readings) {
    const names = readings.map(([name]) => name).join();
    renderOnce(this.readings, names, () =>
      readings.map(([name]) => el("div", {}, el("dt", {}, name), el("dd"))),
    );
    const values = this.readings.querySelectorAll("dd");
    readings.forEach(([, value], index) => setText(values[index], value));
  }

  #showButtons(task, enabled, volatile) {
    setAttribute(this.pause, "hidden", task === null || Boolean(this.resumed));
    setAttribute(this.resume, "hidden", task === null || !this.resumed);
    setAttribute(this.cancel, "hidden", task === null);
    this.resume.volatile = volatile;
    for (const button of [this.pause, this.resume, this.cancel, this.fresh]) button.disabled = !enabled;
  }

  async #toggle() {
    if (this.sheet?.isOpen) this.sheet.close();
    else await this.#open();
  }

  /** Open the sheet, with a file that was dropped. */
  #open(file = null) {
    return whileSending(this.fresh, async () => {
      try {
        await import("/web/js/task/task_sheet.js");
      } catch {
        this.#tell(NOT_LOADED);
        return;
      }
      this.sheet ??= this.#addSheet();
      this.sheet.open(this.#view, file);
      setAttribute(this.fresh, "aria-expanded", "true");
    });
  }

  #addSheet() {
    const sheet = el("ph-task-sheet");
    sheet.addEventListener("ph-closed", () => {
      setAttribute(this.fresh, "aria-expanded", "false");
      this.fresh.focus();
    });
    this.before(sheet);
    return sheet;
  }

  #pause() {
    this.#ask(this.pause, "PUT", `/holds/${OPERATOR}`, { reason: "paused on the page" });
  }

  #resume(volatile) {
    const path = `/holds/${encodeURIComponent(this.resumed)}`;
    this.#ask(this.resume.button, "DELETE", volatile ? `${path}?volatile=true` : path);
  }

  #ask(button, method, path, body) {
    return whileSending(button, async () => {
      let problem = null;
      try {
        await request(method, path, body);
      } catch (error) {
        ({ problem } = error);
      }
      this.#tell(problem);
    });
  }

  #tell(problem) {
    renderOnce(this.problem, JSON.stringify(problem), () => (problem ? problemLines(problem) : []));
    setAttribute(this.problem, "hidden", problem === null);
  }
}

customElements.define("ph-task-strip", TaskStrip);
