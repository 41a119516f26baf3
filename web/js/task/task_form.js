/** <ph-task-form>: a new task from a CSV of waypoints: choose or drop it, preview it, start it.
 *
 * Dispatches `ph-preview` with the service's preview of a file, or with null when there is none any
 * more, and `ph-started` when a task was started.
 */

import { ProblemError, request, requestText } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { hintWords, problemLines } from "/web/js/base/problem.js";
import { whileSending } from "/web/js/base/sending.js";
import { currentTask } from "/web/js/base/store.js";
import { controllerName, previewLines, waypointName } from "/web/js/base/task_words.js";
import { linesOf, textOf } from "/web/js/base/text_file.js";

const UPLOAD_MS = 30_000;
// More than the largest valid track; a video dropped by mistake is not even read.
const MOST_BYTES = 32 * 2 ** 20;
const LINE_SHOWN = 60;
const FILE_WORDS = "x and y in m, and headings if there are any";
const HEADINGS = {
  "": "what fits the path",
  rad: "radians",
  deg: "degrees",
  compass: "compass degrees (clockwise from north)",
  rad_north: "radians from north",
  rad_compass: "compass radians (clockwise from north)",
};

class TaskForm extends HTMLElement {
  #file = null;
  #preview = null;
  #problem = null;
  #tracks = [];
  #asked = 0;
  #busy = false;
  #facts = { task: null, limits: null, enabled: false };

  connectedCallback() {
    this.controller = select({}, () => this.#look());
    this.heading = select(HEADINGS, () => this.#look());
    this.speed = el("input", { type: "number", min: 0.1, max: 11.2, step: 0.1, value: 2.8 });
    this.speed.addEventListener("change", () => this.#look());
    this.headingField = field("Headings in", this.heading);
    this.columns = el("input", { type: "text", placeholder: "x,y,yaw", autocapitalize: "off" });
    this.columns.addEventListener("change", () => this.#look());
    this.columnsField = field("Columns", this.columns);
    this.example = primary(() => this.#drive());
    this.exampleTitle = el("p", { class: "quiet" });
    this.examples = el("div", { class: "examples" }, this.example, this.exampleTitle);
    this.start = primary(() => this.#start());
    this.looking = el("p", { class: "quiet", role: "status" });
    this.away = el("button", { type: "button", onclick: () => this.discard() }, "Discard");
    this.found = el("div", { class: "preview", hidden: true });
    this.refused = el("div", { class: "problem", role: "alert", hidden: true });
    const [controller, speed] = [
      field("Controller", this.controller),
      field("Speed, m/s", this.speed),
    ];
    this.fields = el(
      "fieldset",
      {},
      el("div", { class: "fields" }, controller, speed),
      this.examples,
      this.#zone(),
      this.headingField,
      this.columnsField,
      this.looking,
      this.refused,
      this.found,
      el("div", { class: "sheet-foot" }, this.start, this.away),
    );
    this.append(this.fields);
  }

  /** Request what can be chosen: controllers, and the tracks that come with the service. */
  async load() {
    const [tasks, tracks] = await Promise.all([
      request("GET", "/tasks").catch(() => ({ controllers: [] })),
      // Without example tracks there is no button for them.
      request("GET", "/examples/tracks").catch(() => ({ items: [] })),
    ]);
    const chosen = this.controller.value;
    const named = tasks.controllers.map((name) => [name, controllerName(name)]);
    this.controller.replaceChildren(...options(Object.fromEntries(named)));
    if (tasks.controllers.includes(chosen)) this.controller.value = chosen;
    this.#tracks = tracks.items;
    this.#draw();
  }

  show(state, enabled) {
    const task = currentTask(state);
    const limits = state.vehicle?.limits;
    this.#facts = { task, limits, enabled };
    this.#draw();
  }

  #draw() {
    const { task, limits, enabled } = this.#facts;
    setAttribute(this.fields, "disabled", !enabled);
    for (const button of [this.start, this.example]) setAttribute(button, "disabled", this.#busy);
    if (limits) setAttribute(this.speed, "max", limits.max_speed_mps);
    const track = this.#track();
    setAttribute(this.examples, "hidden", !track || task !== null || this.#file !== null);
    setText(this.example.firstChild, `Drive the example ${track?.name ?? ""}`);
    setText(this.exampleTitle, track?.title ?? "");
    setText(this.fileName, this.#file?.name ?? FILE_WORDS);
    const hint = this.#hints().join(" ");
    const asksHeading = hint.includes("?heading=") || this.heading.value !== "";
    setAttribute(this.headingField, "hidden", !asksHeading);
    const asksColumns = hint.includes("?columns=") || this.columns.value !== "";
    setAttribute(this.columnsField, "hidden", !asksColumns);
    setAttribute(this.start, "hidden", this.#preview === null);
    setAttribute(this.away, "hidden", this.#file === null);
    setText(this.start.firstChild, task ? `Replace task ${task.id}` : "Start");
    setAttribute(this.refused, "hidden", this.#problem === null);
    renderOnce(this.refused, this.#problem, () => this.#refusal());
    setAttribute(this.found, "hidden", this.#preview === null);
    renderOnce(this.found, this.#preview, () => this.#findings());
  }

  /** What is to be said of the file, in words of the interface. */
  #hints() {
    const warnings = this.#preview?.warnings ?? [];
    return [this.#problem, ...warnings].map((told) => told?.hint ?? "");
  }

  #zone() {
    this.choose = el("input", {
      type: "file",
      accept: ".csv,text/csv",
      class: "visually-hidden",
      "aria-label": "Choose a CSV",
      onchange: () => this.#chosen(),
    });
    this.fileName = el("span", { class: "quiet" });
    return el(
      "label",
      { class: "drop" },
      this.choose,
      el("span", { class: "as-button" }, "Choose a CSV"),
      this.fileName,
    );
  }

  #track() {
    return this.#tracks.find(({ name }) => name === "loop") ?? this.#tracks[0] ?? null;
  }

  #chosen() {
    const [file] = this.choose.files;
    if (file) this.take(file);
    // So that the same file can be chosen again after it was corrected.
    this.choose.value = "";
  }

  async take(file) {
    this.discard();
    this.heading.value = "";
    this.columns.value = "";
    const taken = { name: file.name, text: null };
    this.#file = taken;
    if (file.size > MOST_BYTES) return this.#refuse(`${file.name} is too large for a track.`);
    try {
      taken.text = textOf(await file.arrayBuffer());
    } catch {
      // A folder, or a file that was deleted meanwhile.
      return this.#refuse(`${file.name} cannot be read.`);
    }
    if (this.#file === taken) this.#look();
  }

  /** Request a preview of the file; only the answer to the latest request is used. */
  async #look() {
    if (!this.#file || this.#file.text === null) return;
    const asked = ++this.#asked;
    if (!this.speed.checkValidity()) return this.#refuse(this.#speedWords());
    setText(this.looking, `Checking ${this.#file.name} …`);
    const { answer, problem } = await this.#work(() =>
      this.#post("/tasks/preview", this.#file.text),
    );
    if (asked !== this.#asked) return;
    setText(this.looking, "");
    this.#problem = problem;
    this.#show(answer);
  }

  #start(startIndex = null, button = this.start) {
    return whileSending(button, async () => {
      const text = async () => this.#file.text;
      this.#end(await this.#work(() => this.#submit(text, startIndex)));
    });
  }

  #drive(startIndex = null, button = this.example) {
    if (!this.speed.checkValidity()) return this.#refuse(this.#speedWords());
    return whileSending(button, async () => {
      const path = `/examples/tracks/${encodeURIComponent(this.#track().name)}`;
      const drive = () => this.#submit(() => requestText(path), startIndex);
      this.#end(await this.#work(drive));
    });
  }

  #end({ answer, problem }) {
    if (answer) {
      this.discard();
      this.dispatchEvent(new CustomEvent("ph-started"));
      return;
    }
    this.#problem = problem;
    this.#draw();
  }

  #speedWords() {
    return `The speed must be a number from ${this.speed.min} to ${this.speed.max} m/s.`;
  }

  async #submit(text, startIndex) {
    return this.#post("/tasks", await text(), startIndex === null ? {} : { start_index: startIndex });
  }

  /** A vehicle in the middle of a track may start from there. */
  #elsewhere() {
    const { code, available = [] } = this.#problem;
    if (code !== "FAR_START" || available.length === 0) return null;
    const index = available[0];
    const button = el("button", { type: "button" }, `Start at ${waypointName(Number(index))}`);
    button.addEventListener("click", () =>
      this.#file ? this.#start(index, button) : this.#drive(index, button),
    );
    return button;
  }

  /** Forget the file. */
  discard() {
    this.#asked += 1;
    setText(this.looking, "");
    this.#file = null;
    this.#problem = null;
    this.#show(null);
  }

  #show(preview) {
    this.#preview = preview;
    this.#draw();
    this.dispatchEvent(new CustomEvent("ph-preview", { bubbles: true, detail: preview }));
  }

  #refuse(detail) {
    this.#problem = { title: "Rejected", detail, status: 400 };
    this.#show(null);
  }

  #post(path, text, more = {}) {
    const query = new URLSearchParams({
      controller: this.controller.value,
      speed_mps: this.speed.value,
      ...(this.heading.value ? { heading: this.heading.value } : {}),
      ...(this.columns.value ? { columns: this.columns.value } : {}),
      ...more,
    });
    return request("POST", `${path}?${query}`, text, { type: "text/csv", timeoutMs: UPLOAD_MS });
  }

  /** Return the answer or the problem; meanwhile the buttons are disabled. */
  async #work(act) {
    this.#busy = true;
    this.start.disabled = this.example.disabled = true;
    try {
      return { answer: await act(), problem: null };
    } catch (error) {
      if (!(error instanceof ProblemError)) throw error;
      return { answer: null, problem: error.problem };
    } finally {
      this.#busy = false;
      this.#draw();
    }
  }

  #refusal() {
    if (this.#problem === null) return [];
    const { detail, findings = [] } = this.#problem;
    const lines = linesOf(this.#file?.text ?? "");
    const items = findings.map(({ line, message }) => {
      const text = (lines[line - 1] ?? "").trim().slice(0, LINE_SHOWN);
      const said = detail?.includes(message) ? "" : `: ${message}`;
      return el("li", {}, `Line ${line}${said}`, text ? el("code", {}, text) : null);
    });
    const list = items.length ? el("ul", { class: "findings" }, ...items) : null;
    return [...problemLines(this.#problem), list, this.#elsewhere()].filter(Boolean);
  }

  #findings() {
    if (this.#preview === null) return [];
    const lines = previewLines(this.#preview, this.speed.value);
    const warnings = this.#preview.warnings.map(({ message, index, hint }) => {
      const place = typeof index === "number" ? ` (${waypointName(index)})` : "";
      const todo = hint ? `: ${hintWords({ hint })}` : "";
      return el("li", { class: "warning" }, `⚠ ${message}${place}${todo}`);
    });
    return [
      el("h3", {}, "Preview"),
      el("ul", {}, ...lines.map((line) => el("li", {}, withUnits(line))), ...warnings),
    ];
  }
}

/** No line ends between a number and its unit. */
function withUnits(line) {
  return line.replace(/(\d) (?=(m|s|min)\b)/g, "$1\u00a0");
}

function primary(act) {
  return el("button", { type: "button", class: "primary", onclick: act }, el("span"));
}

function field(label, input) {
  return el("label", { class: "field" }, el("span", { class: "quiet" }, label), input);
}

function select(texts, act) {
  return el("select", { onchange: act }, ...options(texts));
}

function options(texts) {
  return Object.entries(texts).map(([value, text]) => el("option", { value }, text));
}

customElements.define("ph-task-form", TaskForm);
