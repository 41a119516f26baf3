/** <ph-alarm>: one error: in two lines what it is, and opened what follows and what can be done.
 *
 * Dispatches `ph-select` with the name of its part, and `ph-show-moment` with when it began.
 */

import { partPath, request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { errorName, isOn, isWaiting, mayGoOn, worseBelow } from "/web/js/base/error_groups.js";
import { showProblem } from "/web/js/base/problem.js";
import { isSame } from "/web/js/base/same.js";
import { plainMessage } from "/web/js/base/signal_words.js";
import { whileSending } from "/web/js/base/sending.js";
import "/web/js/base/sparkline.js";
import { timeAndDay } from "/web/js/base/words.js";
import {
  ageWords,
  factsOf,
  hintOf,
  measured,
  signalOf,
  tagsOf,
} from "/web/js/inspector/error_words.js";
import { consequence, showShape } from "/web/js/inspector/severity.js";
import { splitName } from "/web/js/parts/lines.js";

const BELOW_SHOWN = 20;
/** Names that are longer are above in the title, and not on the button again. */
const LONG = 24;

class Alarm extends HTMLElement {
  #shown = null;
  #path = "";
  #signal;

  connectedCallback() {
    if (this.details) return;
    this.shape = el("span", { class: "shape" });
    this.name = el("strong");
    this.owner = el("span", { class: "alarm-part" });
    this.tags = el("span", { class: "tags" });
    this.age = el("span", { class: "age" });
    this.message = el("span", { class: "alarm-message" });
    this.spark = el("ph-sparkline", { hidden: true });
    this.details = el(
      "details",
      { class: "alarm" },
      el(
        "summary",
        {},
        this.shape,
        el("span", { class: "alarm-title" }, this.name, this.owner, this.tags),
        this.age,
        this.message,
        this.spark,
      ),
    );
    this.details.addEventListener("toggle", () => this.#fillBody());
    this.problem = el("div", { class: "problem", role: "alert", hidden: true });
    this.append(this.details, this.problem);
  }

  set open(value) {
    this.details.open = value;
  }

  /** Show an error, and `below`, what follows from it; the rest is what `<ph-why>` was given. */
  show({ error, below, view }) {
    const { state, enabled, knownAt, volatile } = view;
    setText(this.age, ageWords(error, knownAt));
    setAttribute(this.age, "title", error.since_at ? `since ${timeAndDay(error.since_at)}` : null);
    if (error !== this.#shown?.key[0]) this.#signal = signalOf(error, state.signals);
    const signal = this.#signal;
    if (signal && isOn(error)) this.spark.show(signal, view);
    const told = placed(error, state.errors);
    const key = [error, told.first_out, enabled, volatile, ...below];
    if (this.#shown && isSame(key, this.#shown.key)) return;
    this.#shown = { error: told, below, view, key, signal: state.signals[signal] };
    this.#showHead(told, below, state);
    setAttribute(this.spark, "hidden", !signal || !isOn(error));
    this.#fillBody();
  }

  #showHead(error, below, { signals, parts, devices }) {
    const { part, state } = error;
    // A root is as urgent as the worst that follows from it.
    const { severity } = worseBelow(error, below) ?? error;
    const owner = parts[part] ?? { kind: devices[part] ? "device" : "node", name: part };
    this.#path = `${part === null ? "" : partPath(owner)}/errors/${encodeURIComponent(error.error)}`;
    setAttribute(this, "data-state", state);
    setAttribute(this, "data-severity", severity);
    showShape(this.shape, severity, isOn(error));
    setAttribute(this.details.firstChild, "title", errorName(error));
    setText(this.name, error.error);
    renderOnce(this.owner, String(part), () => (part === null ? [] : namedParts(owner)));
    renderOnce(this.tags, tagsOf(error).join(), () => tagsOf(error).map((tag) => el("span", { class: "tag" }, tag)));
    setText(this.message, plainMessage(error.message, signals));
  }

  /** The body is made when it is first opened: a list may hold hundreds of errors. */
  #fillBody() {
    if (!this.details.open || !this.#shown) return;
    if (!this.body) this.#buildBody();
    const { error, below, view, signal } = this.#shown;
    const worse = worseBelow(error, below);
    setText(this.meaning, consequence(worse ?? error) + (worse ? ` (${errorName(worse)})` : ""));
    setText(this.measure, measured(error, signal));
    setText(this.facts, factsOf(error));
    const hint = hintOf(error);
    setText(this.advice, hint);
    setAttribute(this.advice, "hidden", !hint);
    this.#showBelow(error, below, view);
    this.#showButtons(error, view);
  }

  #buildBody() {
    this.meaning = el("p", { class: "consequence" });
    this.measure = el("p", { class: "measured" });
    this.facts = el("p", { class: "facts" });
    this.advice = el("p", { class: "hint" });
    this.list = el("ul");
    this.summary = el("summary");
    this.below = el("details", { class: "unfold", hidden: true }, this.summary, this.list);
    this.below.addEventListener("toggle", () => this.#fillBody());
    this.held = el("ph-hold-button", { label: "Acknowledge (hold)", hidden: true });
    this.held.addEventListener("ph-held", ({ detail }) => this.#acknowledge(this.held.button, detail));
    this.seen = this.#button("Acknowledge", () => this.#acknowledge(this.seen, {}));
    this.shelve = this.#button("Shelve …", () => this.#openForm());
    this.announce = this.#button("Announce again", () => this.#send(this.announce, "DELETE", "/shelf"));
    this.buttons = el("div", { class: "buttons" }, this.held, this.seen, this.shelve, this.announce);
    const said = [this.meaning, this.measure, this.facts, this.advice];
    this.body = el("div", { class: "alarm-body" }, ...said, this.buttons, this.#links(), this.below);
    this.details.append(this.body);
  }

  #links() {
    this.link = this.#button("", () => this.#tell("ph-select", this.#shown.error.part), "link");
    const tell = () => this.#tell("ph-show-moment", { at: Date.parse(this.#shown.error.since_at) });
    this.moment = this.#button("Show on the timeline", tell, "link");
    return el("div", { class: "links" }, this.link, this.moment);
  }

  #button(text, act, kind = "small") {
    const button = el("button", { type: "button", class: kind }, text);
    button.addEventListener("click", act);
    return button;
  }

  #showBelow(error, below, view) {
    setAttribute(this.below, "hidden", below.length === 0);
    setText(this.summary, `${below.length} ${below.length === 1 ? "follows" : "follow"} from this`);
    if (!this.below.open) return;
    const shown = below.slice(0, BELOW_SHOWN);
    renderOnce(this.list, JSON.stringify([shown.map(errorName), below.length]), () => [
      ...shown.map(() => el("li", {}, el("ph-alarm"))),
      ...(below.length > BELOW_SHOWN ? [el("li", { class: "quiet" }, `and ${below.length - BELOW_SHOWN} more`)] : []),
    ]);
    shown.forEach((each, index) => this.list.children[index].firstChild.show({ error: each, below: [], view }));
  }

  #showButtons(error, { enabled, volatile, state }) {
    const { part, since_at: since, shelved_until_at: until } = error;
    const needsHold = mayGoOn(error);
    setAttribute(this.held, "hidden", !(isWaiting(error) && needsHold));
    this.held.disabled = !enabled;
    this.held.volatile = volatile;
    setAttribute(this.seen, "hidden", !isWaiting(error) || needsHold);
    setAttribute(this.shelve, "hidden", until !== null || (!isOn(error) && !error.chattering));
    setAttribute(this.announce, "hidden", until === null);
    for (const button of [this.seen, this.shelve, this.announce]) setAttribute(button, "disabled", !enabled);
    // Only parts can be selected: the error may be that of a device.
    setAttribute(this.link, "hidden", !(part in state.parts));
    if (part !== null) setText(this.link, `Show ${part.length > LONG ? "the part" : part}`);
    setAttribute(this.moment, "hidden", !since);
    if (until !== null) this.form?.close();
    if (this.form) this.form.enabled = enabled;
  }

  /** The form is loaded when somebody shelves an error for the first time. */
  async #openForm() {
    if (!this.form) {
      await whileSending(this.shelve, () => import("/web/js/inspector/shelve_form.js"));
      this.form = el("ph-shelve-form", { hidden: true });
      this.form.addEventListener("ph-shelve", ({ detail }) => this.#shelve(detail));
      this.form.addEventListener("ph-cancel", () => this.shelve.focus());
      this.buttons.after(this.form);
    }
    this.form.toggle();
  }

  #acknowledge(button, { volatile }) {
    return this.#send(button, "POST", volatile ? "/acknowledge?volatile=true" : "/acknowledge");
  }

  #shelve({ button, for_s, reason }) {
    return this.#send(button, "PUT", "/shelf", { for_s, reason });
  }

  #send(button, method, what, body) {
    return whileSending(button, async () => {
      let problem = null;
      try {
        await request(method, this.#path + what, body);
      } catch (error) {
        if (!error.problem) throw error;
        problem = error.problem;
      }
      showProblem(this.problem, problem);
    });
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true, detail }));
  }
}

/** An error that is on alone came before no other. */
function placed(error, errors) {
  const isAlone = () => !Object.values(errors).some((other) => other !== error && isOn(other));
  return error.first_out && isAlone() ? { ...error, first_out: false } : error;
}

/** "of front_left_whe…vation": the end of a long name tells it from others. */
function namedParts({ kind, name }) {
  const [start, end] = splitName(name);
  return [el("span", {}, `of ${kind === "device" ? "device " : ""}${start}`), el("span", { class: "end" }, end)];
}

customElements.define("ph-alarm", Alarm);
