/** <ph-signal-list>: all signals, urgent ones first.
 *
 * A row is drawn only while it is seen. The order does not change under a pointer.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { hearTrends } from "/web/js/base/trends.js";
import { byUrgency, countWords, rank } from "/web/js/signals/order.js";
import "/web/js/signals/signal_row.js";

const FILTER_FROM = 13;
const REORDER_MS = 1000;
const NEAR = "200px";
const KEYS = { ArrowDown: 1, ArrowUp: -1, Home: -Infinity, End: Infinity };

class SignalList extends HTMLElement {
  #rows = new Map();
  #signals = null;
  #seen = new Set();
  #isDirty = false;
  #orderedAt = -Infinity;
  #isUnderPointer = false;

  connectedCallback() {
    this.count = el("span", { class: "quiet signal-count" });
    this.filter = el("input", {
      type: "search",
      hidden: true,
      placeholder: "Filter signals",
      "aria-label": "Filter signals",
      oninput: () => this.#sift(),
    });
    this.head = el("div", { class: "signals-head" }, el("h2", {}, "Signals"), this.count, this.filter);
    this.empty = el("p", { class: "quiet" }, "Not known yet.");
    this.list = el("div", { role: "list", "aria-label": "Signals" });
    this.append(this.head, this.list, this.empty);
    this.list.addEventListener("pointerenter", () => (this.#isUnderPointer = true));
    this.list.addEventListener("pointerleave", () => (this.#isUnderPointer = false));
    this.list.addEventListener("click", ({ target }) => this.#toggle(target));
    this.list.addEventListener("keydown", (event) => this.#move(event));
    const look = (entries) => this.#look(entries);
    this.sight = new IntersectionObserver(look, { rootMargin: NEAR });
  }

  update(view) {
    hearTrends(view);
    this.view = view;
    const { signals } = view.state;
    if (signals !== this.#signals) this.#take(signals, view.state.at !== null);
    if (this.#isDirty && performance.now() - this.#orderedAt > REORDER_MS) this.#arrange();
    for (const row of this.#seen) row.show(view);
  }

  #take(signals, isKnown) {
    const known = this.#signals ?? {};
    this.#signals = signals;
    if (isKnown && !this.isKnown) this.isKnown = this.#isDirty = true;
    for (const name in signals) {
      const signal = signals[name];
      if (signal === known[name]) continue;
      const row = this.#rows.get(name) ?? this.#add(name, signal);
      const now = rank(signal);
      if (now !== row.rank) this.#isDirty = true;
      row.rank = now;
    }
    for (const [name, row] of this.#rows) if (!signals[name]) this.#drop(name, row);
  }

  #add(name, signal) {
    const row = el("ph-signal-row");
    row.open(name, signal);
    this.#rows.set(name, row);
    this.sight.observe(row);
    this.#orderedAt = -Infinity;
    return row;
  }

  #drop(name, row) {
    this.sight.unobserve(row);
    this.#rows.delete(name);
    this.#seen.delete(row);
    row.remove();
    this.#isDirty = true;
  }

  /** Rows that come into sight are drawn at once. */
  #look(entries) {
    for (const { target, isIntersecting } of entries) {
      if (isIntersecting) this.#seen.add(target);
      else this.#seen.delete(target);
      if (isIntersecting && this.#rows.has(target.name)) target.show(this.view);
    }
  }

  /** Put the rows in order, except under a pointer; the one with the focus is not moved. */
  #arrange() {
    this.#orderedAt = performance.now();
    const rows = [...this.#rows.values()];
    if (this.#isUnderPointer && this.list.childElementCount === rows.length) return this.#sift();
    this.#isDirty = false;
    rows.sort(byUrgency);
    const focused = rows.find((row) => row.contains(document.activeElement)) ?? null;
    const begin = focused ? rows.indexOf(focused) : rows.length;
    for (const row of rows.slice(0, begin)) this.list.insertBefore(row, focused);
    this.list.append(...rows.slice(begin + (focused ? 1 : 0)));
    this.#sift();
  }

  #fits({ name, label }) {
    const wanted = this.filter.value.trim().toLowerCase();
    return `${name} ${label}`.toLowerCase().includes(wanted);
  }

  /** Hide what does not fit the filter, and say how many do. */
  #sift() {
    const rows = [...this.list.children];
    let shown = 0;
    for (const row of rows) {
      const fits = this.#fits(row);
      setAttribute(row, "hidden", !fits);
      if (fits) shown++;
    }
    setAttribute(this.filter, "hidden", rows.length < FILTER_FROM);
    setAttribute(this, "data-many", rows.length >= FILTER_FROM);
    setText(this.count, countWords(rows, shown));
    const isFirst = this.list.querySelector("[tabindex='0']")?.checkVisibility();
    if (!isFirst) this.#setTabStop(rows.find((row) => !row.hidden));
    setAttribute(this.empty, "hidden", shown > 0);
    const wanted = this.filter.value.trim();
    setText(this.empty, wanted ? `No signal is called “${wanted}”.` : "This robot has no signals.");
  }

  #setTabStop(row) {
    this.list.querySelector("[tabindex='0']")?.setAttribute("tabindex", -1);
    row?.button.setAttribute("tabindex", 0);
  }

  #move(event) {
    const step = KEYS[event.key];
    const row = event.target.closest("ph-signal-row");
    if (step === undefined || event.target !== row?.button) return;
    event.preventDefault();
    const rows = [...this.list.children].filter(({ hidden }) => !hidden);
    const next = Math.max(0, Math.min(rows.indexOf(row) + step, rows.length - 1));
    this.#setTabStop(rows[next]);
    rows[next].button.focus();
  }

  async #toggle(target) {
    const row = target.closest("button.signal")?.parentElement;
    if (!row) return;
    this.#setTabStop(row);
    const { toggleDetail } = await import("/web/js/signals/signal_detail.js");
    toggleDetail(row, this.view);
  }
}

customElements.define("ph-signal-list", SignalList);
