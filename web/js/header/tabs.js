/** <ph-tabs>: on a phone, the tabs at the foot, with how much in each asks for attention. */

import { errorGroups } from "/web/js/base/error_groups.js";
import { el, icon, setAttribute, setText } from "/web/js/base/dom.js";
import { partCounts } from "/web/js/base/part_problems.js";

const TABS = ["Status", "Map", "Parts", "Signals", "Log"];
const STEPS = { ArrowLeft: -1, ArrowRight: 1 };

class Tabs extends HTMLElement {
  connectedCallback() {
    this.className = "tabs";
    setAttribute(this, "role", "tablist");
    setAttribute(this, "aria-label", "Panels");
    this.tabs = TABS.map((name) => tab(name));
    this.append(...this.tabs.map(({ button }) => button));
    for (const { name, button } of this.tabs) button.addEventListener("click", () => this.#choose(name));
    this.addEventListener("keydown", (event) => this.#move(event));
    const narrow = matchMedia("(max-width: 1023px)");
    narrow.addEventListener("change", () => letScroll(narrow.matches));
    letScroll(narrow.matches);
  }

  update({ state }) {
    const chosen = document.body.dataset.tab;
    if (this.chosen !== chosen) {
      this.chosen = chosen;
      for (const { name, button } of this.tabs) {
        setAttribute(button, "aria-selected", String(name === chosen));
        setAttribute(button, "tabindex", name === chosen ? 0 : -1);
      }
    }
    if (this.seen?.ownDevice !== state.ownDevice) this.#leaveOutMap(state.ownDevice !== null);
    if (this.seen?.errors !== state.errors) this.#count("status", errorCount(state.errors), "error");
    if (this.seen?.parts !== state.parts) this.#count("parts", partCount(state), "attention");
    if (this.seen?.signals !== state.signals) this.#count("signals", signalCount(state.signals), "attention");
    this.seen = state;
  }

  /** A device has neither vehicle nor task. */
  #leaveOutMap(isLeftOut) {
    setAttribute(document.getElementById("panels-map"), "hidden", isLeftOut);
    if (isLeftOut && document.body.dataset.tab === "map") this.#choose("status");
  }

  #count(tabName, number, level) {
    const { button, title, count } = this.tabs.find(({ name }) => name === tabName);
    setText(count, number > 99 ? "99+" : String(number));
    setAttribute(count, "hidden", number === 0);
    setAttribute(count, "data-level", level);
    setAttribute(button, "aria-label", number ? `${title}, ${number} to attend to` : title);
  }

  #choose(name) {
    this.dispatchEvent(new CustomEvent("ph-tab", { bubbles: true, detail: name }));
  }

  #move(event) {
    const tabs = this.tabs.filter(({ button }) => !button.hidden);
    const at = tabs.findIndex(({ name }) => name === this.chosen);
    const step = STEPS[event.key];
    const to = event.key === "Home" ? 0 : event.key === "End" ? tabs.length - 1 : step && at + step;
    if (to === undefined) return;
    event.preventDefault();
    const { name, button } = tabs[(to + tabs.length) % tabs.length];
    this.#choose(name);
    button.focus();
  }
}

/** What scrolls as a whole is scrolled by keys too. */
function letScroll(isOne) {
  setAttribute(document.getElementById("panels"), "tabindex", isOne ? 0 : null);
}

function tab(title) {
  const name = title.toLowerCase();
  const count = el("span", { class: "count", "aria-hidden": "true", hidden: true });
  const props = { type: "button", role: "tab", id: `panels-${name}`, "aria-controls": "panels", "aria-label": title };
  return { name, title, count, button: el("button", props, icon(name), el("span", {}, title), count) };
}

/** As many as Why counts: what follows from an error is attended to with it. */
function errorCount(errors) {
  return errorGroups(errors).on.length;
}

function partCount({ parts, devices }) {
  const { deviating, unreachable } = partCounts(parts, devices);
  return deviating + unreachable;
}

function signalCount(signals) {
  return Object.values(signals).filter(({ error, pending, stale }) => error || pending || stale).length;
}

customElements.define("ph-tabs", Tabs);
