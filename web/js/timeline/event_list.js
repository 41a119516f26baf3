/** <ph-event-list>: events, newest first; lines mark missing events and restarts.
 *
 * Earlier events are loaded at its end, over restarts of the service. What an event follows from is
 * asked for when somebody wants to know; its time shows that moment in all panels.
 */

import { request } from "/web/js/base/api.js";
import { el } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { emptyState, firstEventId } from "/web/js/base/store.js";
import { isoDate, timeAndDay, timeOfDay } from "/web/js/base/words.js";
import { causesOf } from "/web/js/timeline/causes.js";

const SHOWN = 50;
const LOADED = 200;
const END_PX = 40;

class EventList extends HTMLElement {
  #state = emptyState();
  #lines = new Map();
  #shown = SHOWN;
  #isSeen = false;
  #isDue = false;
  #updated = () => {};

  connectedCallback() {
    this.details = el("input", { type: "checkbox", role: "switch" });
    this.list = el("ol", {
      class: "events",
      tabindex: "0",
      "aria-label": "Recent events, newest first",
    });
    this.earlier = el("button", { class: "small", hidden: true }, "Earlier");
    this.failure = el("p", { class: "hint", role: "status" });
    const details = el("label", { class: "switch" }, this.details, el("span", {}, "Show details"));
    this.append(
      el("div", { class: "event-bar" }, details, this.earlier, this.failure),
      this.list,
    );
    this.details.addEventListener("change", () => this.#render());
    this.earlier.addEventListener("click", () => this.#showEarlier());
    this.list.addEventListener("scroll", () => this.#scrolled());
    new IntersectionObserver(([{ isIntersecting }]) => {
      this.#isSeen = isIntersecting;
      if (isIntersecting && this.#isDue) this.#render();
    }).observe(this);
  }

  /** The list now, also of a moment: what happened does not change. */
  update({ live }) {
    this.#isDue ||= this.#state.events !== live.events;
    this.#state = live;
    this.#updated();
    if (this.#isDue && this.#isSeen) this.#render();
  }

  #scrolled() {
    const { scrollTop, clientHeight, scrollHeight } = this.list;
    const isAtEnd = scrollTop > 0 && scrollTop + clientHeight > scrollHeight - END_PX;
    if (isAtEnd && !this.earlier.hidden && !this.failure.textContent) this.#showEarlier();
  }

  /** Show more of what is known, and load what is before it. */
  async #showEarlier() {
    if (this.earlier.hasAttribute("data-sending")) return;
    this.#shown += SHOWN;
    if (this.#wanted().length < this.#shown && this.#hasEarlier()) {
      const path = `/events?before=${firstEventId(this.#state)}&limit=${LOADED}`;
      await whileSending(this.earlier, () => this.#load(path));
    }
    this.#render();
  }

  async #load(path) {
    try {
      const detail = await request("GET", path);
      this.failure.textContent = "";
      this.dispatchEvent(new CustomEvent("ph-earlier", { bubbles: true, detail }));
      // The store has them at once, this list with the next drawing.
      await new Promise((resolve) => (this.#updated = resolve));
    } catch (error) {
      this.failure.textContent = error.message;
    }
  }

  #hasEarlier() {
    const first = firstEventId(this.#state);
    return first !== null && first > this.#state.oldestEventId;
  }

  #wanted() {
    const lines = withRestarts(this.#state.events);
    return lines.filter((line) => this.details.checked || isNotable(line));
  }

  #render() {
    this.#isDue = false;
    const wanted = this.#wanted();
    const lines = new Map();
    for (const line of withDays(wanted.slice(-this.#shown)))
      lines.set(line, this.#lines.get(line) ?? makeLine(line));
    this.#lines = lines;
    this.list.toggleAttribute("data-details", this.details.checked);
    this.#keepPlace(() => this.list.replaceChildren(...[...lines.values()].reverse()));
    this.earlier.hidden = wanted.length <= this.#shown && !this.#hasEarlier();
  }

  /** Whoever reads further down keeps the line before the eyes while new ones arrive. */
  #keepPlace(render) {
    const { list } = this;
    const top = list.getBoundingClientRect().top;
    const isBelow = (line) => line.getBoundingClientRect().bottom > top;
    const read = list.scrollTop > 0 ? [...list.children].find(isBelow) : undefined;
    const place = read?.getBoundingClientRect().top;
    const focused = list.contains(document.activeElement) ? document.activeElement : null;
    render();
    if (read?.isConnected) list.scrollTop += read.getBoundingClientRect().top - place;
    if (focused?.isConnected && focused !== document.activeElement) focused.focus({ preventScroll: true });
  }
}

/** Return events and notes, with a line between two runs; ids lost in between belong to it. */
function withRestarts(events) {
  const lines = [];
  let epoch = null;
  let notes = [];
  for (const event of events) {
    if (event.note) {
      notes.push(event);
      continue;
    }
    const isOfNextRun = epoch !== null && event.epoch !== epoch;
    const isTold = notes.some((note) => note.isRestart);
    if (isOfNextRun && !isTold) lines.push(restartLine(event, notes.length > 0));
    else lines.push(...notes);
    lines.push(event);
    epoch = event.epoch;
    notes = [];
  }
  return [...lines, ...notes];
}

function restartLine({ at }, isCutOff) {
  const lost = isCutOff ? "; the last events before may be missing" : "";
  return { note: `Restarted at ${timeAndDay(at)}${lost}`, isRestart: true, at };
}

/** Return lines with one above those of each day but today. */
function withDays(lines) {
  const dayOf = ({ at }) => (at ? isoDate(at) : null);
  const today = isoDate(Date.now());
  const all = [];
  let day = today;
  for (const line of lines) {
    const next = dayOf(line) ?? day;
    if (next !== day && day !== today) all.push({ note: day, isDay: true });
    all.push(line);
    day = next;
  }
  return day === today ? all : [...all, { note: day, isDay: true }];
}

/** Notable events are always shown, and so are lines for missing events. */
function isNotable(event) {
  return Boolean(event.note) || event.notable;
}

function makeLine(event) {
  if (event.note) return el("li", { class: event.isDay ? "day" : event.isRestart ? "restart" : "gap" }, event.note);
  const line = el("li", { "data-kind": event.kind });
  const time = el("time", { datetime: event.at, title: event.at }, timeOfDay(event.at));
  const show = () => line.dispatchEvent(new CustomEvent("ph-show-moment", { bubbles: true, detail: { at: Date.parse(event.at) } }));
  const kind = el("span", { class: "event-kind" }, event.kind.replace(/[._]/g, " "));
  const name = `Show ${timeOfDay(event.at)} in all panels`;
  line.append(
    el("button", { type: "button", class: "event-time", title: name, onclick: show }, time),
    el("p", {}, el("span", { class: "event-words" }, event.words), " ", kind),
  );
  if (event.cause !== null) line.append(...causesOf(event));
  return line;
}

customElements.define("ph-event-list", EventList);
