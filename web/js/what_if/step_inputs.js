/** What happens in a scenario: a form that adds a step, and the steps with their refusals. */

import { partPath, request } from "/web/js/base/api.js";
import { el, setAttribute } from "/web/js/base/dom.js";
import { modeName } from "/web/js/base/words.js";
import { KINDS } from "/web/js/what_if/steps.js";

/** Calls `changed` when a step was added or taken away. */
export class StepInputs {
  /** `{t_s, step, words, refusal}`, in the order in which they were added. */
  entries = [];

  constructor(changed) {
    this.changed = changed;
    this.kind = select("What happens", Object.entries(KINDS).map(([name, { words }]) => [name, words]));
    this.target = select("To what");
    this.option = select("How");
    this.at = el("input", { type: "number", min: 0, max: 3600, step: "any", value: 1, "aria-label": "After how many seconds" });
    this.add = el("button", { class: "small" }, "Add");
    const when = el("label", {}, "after ", this.at, " s");
    this.form = el("form", { class: "what-if-form" }, this.kind, this.target, this.option, when, this.add);
    this.list = el("ul", { class: "what-if-steps", "aria-label": "Steps of the simulation" });
    this.node = el("div", {}, this.form, this.list);
    this.kind.addEventListener("change", () => this.#chooseTargets());
    this.target.addEventListener("change", () => this.#chooseOptions());
    this.form.addEventListener("submit", (event) => this.#submit(event));
  }

  /** The steps as the simulation takes them. */
  get steps() {
    return this.entries.map(({ t_s, step }) => ({ t_s, ...step }));
  }

  /** Offer what the robot has now. */
  open(state) {
    this.state = state;
    this.#chooseTargets();
  }

  clear() {
    this.entries = [];
    this.#draw();
  }

  /** Show beside each step why it was refused; `problems` are in the order of time. */
  tellRefusals(problems) {
    const inTime = [...this.entries].sort((a, b) => a.t_s - b.t_s);
    inTime.forEach((entry, index) => (entry.refusal = problems.get(index) ?? null));
    this.#draw();
  }

  get #chosen() {
    return KINDS[this.kind.value];
  }

  #chooseTargets() {
    const { targets } = this.#chosen;
    fill(this.target, targets?.(this.state) ?? []);
    setAttribute(this.target, "hidden", !targets);
    this.#chooseOptions();
  }

  async #chooseOptions() {
    const { options } = this.#chosen;
    const target = this.target.value;
    setAttribute(this.option, "hidden", !options);
    fill(this.option, []);
    if (!options) return;
    const found = await options(target, (part) => this.#modesOf(part));
    if (target === this.target.value && options === this.#chosen.options) fill(this.option, found);
  }

  async #modesOf(name) {
    const part = this.state.parts[name];
    if (!part) return [];
    const { items } = await request("GET", `${partPath(part)}/modes`).catch(() => ({ items: [] }));
    return items.map(({ mode }) => [mode, modeName(mode)]);
  }

  #submit(event) {
    event.preventDefault();
    const { targets, options, step, said } = this.#chosen;
    const [target, option] = [this.target.value, this.option.value];
    if ((targets && !target) || (options && !option)) return;
    const t_s = Math.max(0, this.at.valueAsNumber || 0);
    this.entries.push({ t_s, step: step(target, option), words: said(target, option), refusal: null });
    this.#draw();
    this.changed();
  }

  #draw() {
    const rows = this.entries.map((entry) => {
      const words = `after ${entry.t_s} s: ${entry.words}`;
      const drop = () => {
        this.entries = this.entries.filter((other) => other !== entry);
        this.#draw();
        this.changed();
      };
      const button = el("button", { class: "small", "aria-label": `Take away: ${words}`, onclick: drop }, "×");
      const refused = entry.refusal ? el("p", { class: "refusal" }, `Refused: ${entry.refusal}`) : null;
      return el("li", {}, el("span", {}, words), button, refused);
    });
    this.list.replaceChildren(...rows);
  }
}

function select(name, choices = []) {
  const node = el("select", { "aria-label": name });
  fill(node, choices);
  return node;
}

function fill(node, choices) {
  node.replaceChildren(...choices.map(([value, words]) => el("option", { value }, words)));
}
