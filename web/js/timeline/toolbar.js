/** The bar above the lanes: what is shown, how much of it, and what can be done with it. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { SPANS } from "/web/js/timeline/range.js";

export class Toolbar {
  /** @param act `{span(ms), zoom(factor), now(), table(), save(button), step(way), tab(name)}` */
  constructor(act) {
    this.tabs = ["timeline", "log"].map((name) => tabOf(name, act));
    this.spans = SPANS.map(([span, text]) =>
      el("button", { type: "button", "data-span": span, onclick: () => act.span(span) }, text),
    );
    this.now = el("button", { type: "button", title: "Follow now (End)", onclick: () => act.now() }, "Now");
    this.table = el("button", { type: "button", onclick: () => act.table() }, "Table");
    this.save = el(
      "button",
      {
        type: "button",
        title: "Save the events of this span as JSON lines",
        onclick: () => act.save(this.save),
      },
      "Export",
    );
    this.cut = el("span", { class: "cut", hidden: true });
    this.when = el("strong");
    this.pin = el(
      "div",
      { class: "pin", hidden: true },
      this.when,
      step("◀", "Show the previous event (left arrow)", () => act.step(-1)),
      step("▶", "Show the next event (right arrow)", () => act.step(1)),
    );
    this.root = el(
      "div",
      { class: "timeline-bar" },
      el("div", { class: "timeline-tabs", role: "tablist", "aria-label": "Timeline or log" }, ...this.tabs),
      el("div", { class: "spans", role: "group", "aria-label": "Span" }, ...this.spans, this.now),
      el(
        "div",
        { class: "zoom", role: "group", "aria-label": "Zoom" },
        step("−", "Zoom out (minus)", () => act.zoom(1 / 2)),
        step("+", "Zoom in (plus)", () => act.zoom(2)),
      ),
      this.cut,
      el("div", { class: "timeline-acts" }, this.table, this.save),
      this.pin,
    );
  }

  /** Show `{tab, span, follows, isTable, pinned, cut}`; `pinned` is the text of a moment, or empty. */
  show({ tab, span, follows, isTable, pinned, cut }) {
    for (const one of this.tabs) {
      const isChosen = one.id === `tab-${tab}`;
      setAttribute(one, "aria-selected", String(isChosen));
      setAttribute(one, "tabindex", isChosen ? 0 : -1);
    }
    for (const button of this.spans)
      setAttribute(button, "aria-pressed", String(Number(button.dataset.span) === span));
    setAttribute(this.now, "disabled", follows);
    setAttribute(this.table, "aria-pressed", String(isTable));
    setAttribute(this.pin, "hidden", !pinned);
    setText(this.when, pinned);
    setAttribute(this.cut, "hidden", !cut);
    setText(this.cut, cut);
  }
}

/** A tab; the arrow keys go from one to the other. */
function tabOf(name, act) {
  const words = name === "log" ? "Log" : "Timeline";
  const tab = el("button", {
    type: "button",
    role: "tab",
    id: `tab-${name}`,
    "aria-controls": `panel-${name}`,
    onclick: () => act.tab(name),
  });
  tab.append(words);
  tab.addEventListener("keydown", ({ key }) => {
    if (key !== "ArrowLeft" && key !== "ArrowRight") return;
    const other = name === "log" ? "timeline" : "log";
    act.tab(other);
    document.getElementById(`tab-${other}`).focus();
  });
  return tab;
}

function step(text, name, act) {
  return el("button", { type: "button", "aria-label": name, title: name, onclick: act }, text);
}
