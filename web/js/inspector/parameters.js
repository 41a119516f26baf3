/** <ph-parameters>: the parameters of a node, those that are not as wanted first. */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";

class Parameters extends HTMLElement {
  connectedCallback() {
    if (this.details) return;
    this.count = el("span", { class: "quiet" });
    this.table = el("div");
    this.details = el("details", { class: "fold" }, el("summary", {}, "Parameters ", this.count), this.table);
    this.details.addEventListener("toggle", () => this.#fill());
    this.append(this.details);
  }

  /** Show what `GET /nodes/{node}/parameters` answered; null: the part has none, or not yet. */
  show({ parameters }) {
    this.items = parameters ?? [];
    setAttribute(this, "hidden", this.items.length === 0);
    const differing = this.items.filter(isDiffering).length;
    setText(this.count, differing ? `${this.items.length}, ${differing} not as wanted` : `${this.items.length}`);
    setAttribute(this, "data-differing", differing > 0);
    this.#fill();
  }

  #fill() {
    if (!this.details.open) return;
    const order = (a, b) => isDiffering(b) - isDiffering(a) || a.name.localeCompare(b.name);
    const sorted = [...this.items].sort(order);
    renderOnce(this.table, JSON.stringify(sorted), () => [tableOf(sorted)]);
  }
}

function tableOf(items) {
  const isWanted = items.some(({ wanted }) => wanted !== null);
  const head = ["Parameter", "Actual", ...(isWanted ? ["Wanted"] : [])];
  return el(
    "table",
    { class: "parameters" },
    el("thead", {}, el("tr", {}, ...head.map((text) => el("th", { scope: "col" }, text)))),
    el("tbody", {}, ...items.map((item) => row(item, isWanted))),
  );
}

function row(item, isWanted) {
  const { name, value, wanted } = item;
  return el(
    "tr",
    { "data-differing": isDiffering(item) },
    el("th", { scope: "row", title: name }, name),
    cell(value),
    ...(isWanted ? [cell(wanted, "–")] : []),
  );
}

/** A value is cut to the width of its column; its title has it whole. */
function cell(value, none = "?") {
  const text = valueText(value, none);
  return el("td", { title: text }, text);
}

function valueText(value, none) {
  if (value === null || value === undefined) return none;
  return typeof value === "string" ? value : JSON.stringify(value);
}

function isDiffering({ value, wanted }) {
  return wanted !== null && JSON.stringify(value) !== JSON.stringify(wanted);
}

customElements.define("ph-parameters", Parameters);
