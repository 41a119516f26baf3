/** <ph-signal-row>: one signal in a line: its state, name, last minute and value. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { describe } from "/web/js/base/signal_catalog.js";
import { ageWords, pendingFor, pendingWords, valueWords, verdict } from "/web/js/base/signal_words.js";
import "/web/js/base/sparkline.js";

/** A name that is longer is cut in its middle; the end stays, since names differ there. */
const LONG = 20;
const TAIL = 5;
/** A shape for each level, so that colour is not all that tells them apart. */
const SHAPES = {
  ok: "M8 6.5a1.5 1.5 0 1 0 .01 0",
  unknown: "M5.5 6a2.5 2.5 0 1 1 3.6 2.2C8.2 8.7 8 9.2 8 10M8 12.4v.1",
  stale: "M8 2.5a5.5 5.5 0 1 0 .01 0M8 5v3l2 1.5",
  error: "M8 2l6.5 11.5h-13zM8 6v3.4M8 11.3v.2",
  pending: "",
};

class SignalRow extends HTMLElement {
  #seen = {};

  connectedCallback() {
    this.role = "listitem";
  }

  /** Name the row at once; the rest is built when it is seen. */
  open(name, signal) {
    this.name = name;
    this.label = describe(name, signal).label;
    this.title = this.label;
    this.word = el("span", { class: "signal-word" });
    this.button = el(
      "button",
      { class: "signal", tabindex: -1, "aria-expanded": "false" },
      (this.shape = shape()),
      el(
        "span",
        { class: "signal-name" },
        el("span", { class: "signal-label" }, ...labelParts(this.label)),
        this.word,
      ),
    );
    this.append(this.button);
  }

  /** Show what changed of a row that is seen. */
  show(view) {
    const signal = view.state.signals[this.name];
    const isLive = view.contact.level !== "lost";
    const second = Math.floor(view.serverNow / 1000);
    const seen = this.#seen;
    const isEngaged = this.name === "estop" && view.state.emergencyStop?.engaged;
    const isSame = seen.signal === signal && seen.isLive === isLive && seen.isEngaged === isEngaged;
    if (isSame && seen.second === second) return;
    this.#seen = { signal, isLive, second, isEngaged };
    if (!this.spark) this.#build();
    const [value, unit, aside] = valueWords(this.name, signal, view.state.emergencyStop);
    setText(this.value, value);
    setText(this.unit, unit);
    setAttribute(this.reading, "title", `${value} ${unit}`.trimEnd());
    this.#judge(signal, aside, isLive, view.serverNow);
    this.spark.show(this.name, view);
    this.detail?.show(view);
  }

  #build() {
    this.spark = el("ph-sparkline");
    this.value = el("span", { class: "value" });
    this.unit = el("span", { class: "unit" });
    this.age = el("span", { class: "age" });
    this.reading = el("span", {}, this.value, " ", this.unit);
    this.button.append(this.spark, el("span", { class: "signal-reading" }, this.reading, this.age));
  }

  #judge(signal, aside, isLive, now) {
    const { level, text } = verdict(signal, isLive, now);
    setAttribute(this, "data-level", level);
    setAttribute(this, "data-severity", signal.settings.severity);
    setText(this.word, text);
    setAttribute(this.shape.firstChild, "d", SHAPES[level]);
    setAttribute(this.shape.lastChild, "hidden", level !== "pending");
    if (level !== "pending") {
      setText(this.age, ageWords(signal, isLive, now) || aside);
      return;
    }
    setText(this.age, pendingWords(signal.pending, now));
    const share = pendingFor(signal.pending, now) / signal.pending.needs_s;
    setAttribute(this.shape.lastChild, "stroke-dasharray", `${Math.round(share * 100)} 100`);
  }
}

/** The name; a long one in two parts for the eye and in one for the ear. */
function labelParts(label) {
  if (label.length <= LONG) return [el("span", {}, label)];
  const parts = [label.slice(0, -TAIL), label.slice(-TAIL)];
  const seen = parts.map((text) => el("span", { "aria-hidden": "true" }, text));
  return [el("span", { class: "visually-hidden" }, label), ...seen];
}

/** A shape, and the ring of a pending error, which fills. */
function shape() {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  const path = document.createElementNS(space, "path");
  const ring = document.createElementNS(space, "g");
  const fill = document.createElementNS(space, "circle");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  svg.setAttribute("class", "signal-shape");
  for (const [name, value] of [["cx", 8], ["cy", 8], ["r", 5.5], ["pathLength", 100]])
    fill.setAttribute(name, value);
  ring.append(fill);
  svg.append(path, ring);
  return svg;
}

customElements.define("ph-signal-row", SignalRow);
