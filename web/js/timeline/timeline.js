/** <ph-timeline>: what happened, on lanes; a press pins all panels to a moment. With the log. */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { timeAndDay } from "/web/js/base/words.js";
import { chosenParts, loadKept, storeKept } from "/web/js/timeline/chosen_parts.js";
import { EventRecord, MOST_EVENTS } from "/web/js/timeline/event_record.js";
import "/web/js/timeline/event_list.js";
import { itemsAt } from "/web/js/timeline/describe.js";
import { exportEvents } from "/web/js/timeline/export.js";
import { listen } from "/web/js/timeline/gestures.js";
import { keysOf } from "/web/js/timeline/keys.js";
import { laneName } from "/web/js/timeline/lane_name.js";
import { lanesOf } from "/web/js/timeline/lanes.js";
import { LanesView } from "/web/js/timeline/lanes_view.js";
import { edgesOf, xOf } from "/web/js/timeline/marks.js";
import { refusalWords, stateAt } from "/web/js/timeline/moment.js";
import { MINUTE, moved, scaleOf, showing, zoomed } from "/web/js/timeline/range.js";
import { tableOf } from "/web/js/timeline/table.js";
import { Tip } from "/web/js/timeline/tip.js";
import { Toolbar } from "/web/js/timeline/toolbar.js";

/** While nobody touches it, it is drawn this often at most. */
const REDRAW_MS = 1000;
/** Whoever steps through events with a key held down asks only for the last. */
const STEP_MS = 250;
const LOAD_MS = 200;
const SNAP_PX = 4;
const NOTE_MS = 12_000;

class Timeline extends HTMLElement {
  #view = null;
  #range = { span: 10 * MINUTE, end: null };
  #kept = loadKept();
  #chosen = { names: [], isAll: true };
  #record = new EventRecord(() => this.#ask());
  #lanes = [];
  #dark = [];
  #edges = [];
  #lanesKey = "";
  #drawnKey = "";
  #drawnAt = -Infinity;
  #drawAsked = false;
  #isSeen = false;
  #tab = "timeline";
  #isTable = false;
  #cursor = null;
  #lane = "state";
  /** The moment that is asked for, ms; null: none. */
  #pending = null;
  #asked = null;
  #problem = "";

  connectedCallback() {
    this.bar = new Toolbar({
      span: (span) => this.#look({ ...this.#range, span }),
      zoom: (factor) => this.#zoom(factor, this.lanes.width / 2),
      now: () => this.#follow(),
      table: () => this.#toggleTable(),
      save: (button) => this.#save(button),
      step: (way) => this.#step(way),
      tab: (name) => this.#show(name),
    });
    this.lanes = new LanesView(() => this.#ask());
    this.tip = new Tip();
    this.table = el("div", { class: "lane-table", hidden: true, tabindex: 0, role: "region", "aria-label": "Table of the timeline" });
    this.note = el("p", { class: "timeline-note", role: "status" });
    this.log = el("ph-event-list", { id: "panel-log", role: "tabpanel", "aria-labelledby": "tab-log" });
    const panel = { class: "timeline-panel", id: "panel-timeline", role: "tabpanel", "aria-labelledby": "tab-timeline" };
    const keys = el("p", { id: "timeline-keys", class: "visually-hidden" }, KEYS);
    this.append(
      this.bar.root,
      this.note,
      el("div", panel, this.lanes.root, this.table, keys),
      this.log,
      this.tip.root,
    );
    setAttribute(this, "data-tab", this.#tab);
    this.#listen();
  }

  update(view) {
    const wasPinned = this.#view?.moment?.at ?? null;
    this.#view = view;
    this.#record.hear(view.live);
    this.log.update?.(view);
    if (!this.#isSeen) return;
    const pinned = view.moment?.at ?? null;
    if (pinned !== wasPinned) this.#pinChanged(pinned);
    const due = performance.now() - this.#drawnAt >= REDRAW_MS;
    if (due && this.#key() !== this.#drawnKey) this.#draw();
  }

  #listen() {
    const canvas = this.lanes.canvas;
    listen(canvas, {
      point: (x, y, event) => this.#point(x, y, event),
      leave: () => this.#point(null),
      press: (x) => this.#press(x),
      pan: (dx) => this.#pan(dx),
      zoom: (factor, x) => this.#zoom(factor, x),
    });
    const act = {
      step: (way) => this.#step(way),
      lane: (way) => this.#moveLane(way),
      pin: () => this.#cursor !== null && this.#pin(this.#cursor),
      pan: (way) => this.#pan(-way * this.lanes.width * 0.25),
      zoom: (factor) => this.#zoom(factor, this.#cursorX()),
      begin: () => this.#toEdge(0),
      now: () => this.#follow(),
    };
    canvas.addEventListener("keydown", keysOf(act));
    canvas.addEventListener("focus", () => this.#focus());
    canvas.addEventListener("blur", () => this.#point(null));
    document.addEventListener("keydown", (event) => {
      const isPinned = this.#pending !== null || this.#view?.moment;
      // With Shift it is the key of STOP.
      if (event.key === "Escape" && !event.shiftKey && isPinned) this.#release();
    });
    document.addEventListener("ph-show-moment", ({ detail }) => this.#showMoment(detail.at));
    new IntersectionObserver(([{ isIntersecting }]) => {
      this.#isSeen = isIntersecting;
      if (isIntersecting) this.#ask();
    }).observe(this);
  }

  #now() {
    const { live, contact, knownAt } = this.#view;
    if (!live.at) return knownAt;
    return Date.parse(live.at) + (contact.level === "lost" ? contact.silenceMs : 0);
  }

  get #pinned() {
    return this.#pending ?? this.#view?.moment?.at ?? null;
  }

  /** What a drawing depends on: drawn again only if it differs. */
  #key() {
    const scale = scaleOf(this.#range, this.#now(), this.lanes.width);
    const { selected, contact } = this.#view;
    const facts = [scale.from, scale.to, this.#record.version, selected, this.#pinned, this.#cursor];
    const shown = [this.lanes.width, this.lanes.scheme, contact.level];
    return [...facts, this.#kept, ...shown, this.#lane, this.#pending].join();
  }

  #ask() {
    if (this.#drawAsked || !this.#view) return;
    this.#drawAsked = true;
    requestAnimationFrame(() => {
      this.#drawAsked = false;
      if (this.#isSeen) this.#draw();
    });
  }

  #draw() {
    this.#drawnAt = performance.now();
    this.#drawnKey = this.#key();
    const now = this.#now();
    this.#prepare(now);
    const scene = { lanes: this.#lanes, dark: this.#dark, range: this.#range, now, chosen: this.#focusedLane() };
    const namesKey = `${this.#chosen.isAll} ${this.#kept}`;
    const marks = { namesKey, pinned: this.#pinned, isPending: this.#pending !== null, cursor: this.#cursor };
    if (!this.#isTable) this.lanes.draw({ ...scene, ...marks }, (lane, height) => this.#nameOf(lane, height));
    else this.#drawTable(now);
    this.#drawBar();
    this.#speak(now);
  }

  /** Load what is missing, and make lanes of what is known. */
  #prepare(now) {
    const { live, selected, contact } = this.#view;
    this.#chosen = chosenParts(live.parts, selected, this.#kept);
    this.#load(now);
    const from = this.#record.from;
    const { names } = this.#chosen;
    const key = [this.#record.version, from, contact.level, Boolean(live.systemState), ...names].join();
    if (key === this.#lanesKey) return;
    this.#lanesKey = key;
    const known = this.#record.known(from, live);
    this.#dark = contact.level === "lost" ? [...known.dark, unheard(live)] : known.dark;
    this.#lanes = from === Infinity ? [] : lanesOf({ ...known, dark: this.#dark }, names);
    this.#edges = edgesOf(this.#lanes);
  }

  /** A little more than is seen is loaded, so that not each pixel of a move asks again. */
  #load(now) {
    const { from, to } = scaleOf(this.#range, now, this.lanes.width || 1);
    const isEnough = this.#record.from <= from;
    clearTimeout(this.loading);
    const load = () => this.#record.load(Math.floor(isEnough ? from : from - (to - from) / 4), this.#chosen.names);
    if (this.#record.from === Infinity || isEnough) load();
    else this.loading = setTimeout(load, LOAD_MS);
  }

  #nameOf(lane, height) {
    const { isAll } = this.#chosen;
    const part = lane.key.startsWith("part:") ? lane.name : null;
    const isKept = this.#kept.includes(lane.name);
    const canKeep = part !== null && !isAll;
    return laneName(lane, height, { part, canKeep, isKept, keep: () => this.#keep(lane.name) });
  }

  #keep(name) {
    const isKept = this.#kept.includes(name);
    this.#kept = isKept ? this.#kept.filter((one) => one !== name) : [...this.#kept, name];
    storeKept(this.#kept);
    this.#ask();
  }

  #drawBar() {
    const at = this.#view.moment?.at;
    const span = this.#range.span;
    const state = { tab: this.#tab, span, follows: this.#range.end === null, isTable: this.#isTable };
    const cut = this.#record.isCut ? `only the last ${MOST_EVENTS.toLocaleString("en-GB")} events` : "";
    this.bar.show({ ...state, cut, pinned: at ? timeAndDay(at) : "" });
    setAttribute(this, "data-pinned", Boolean(at));
    const { problem } = this.#record;
    if (problem !== this.#problem) this.#tell(problem && `Earlier events are not shown: ${problem}`);
    this.#problem = problem;
  }

  #drawTable(now) {
    const { from, to } = scaleOf(this.#range, now, this.lanes.width || 1);
    const key = [this.#lanesKey, this.#range.span, this.#range.end].join();
    renderOnce(this.table, key, () => tableOf(this.#lanes, this.#dark, { from, to, now }));
  }

  #toggleTable() {
    this.#isTable = !this.#isTable;
    setAttribute(this.lanes.root, "hidden", this.#isTable);
    setAttribute(this.table, "hidden", !this.#isTable);
    this.#ask();
  }

  #show(tab) {
    this.#tab = tab;
    setAttribute(this, "data-tab", tab);
    this.#drawBar();
    this.#ask();
  }

  #look(range) {
    this.#range = range;
    this.#ask();
  }

  /** Now is where live is. */
  #follow() {
    if (this.#pinned !== null) this.#release();
    this.#look({ ...this.#range, end: null });
  }

  #zoom(factor, x) {
    this.#look(zoomed(this.#range, factor, x / Math.max(1, this.lanes.width), this.#now()));
  }

  #pan(dx) {
    const by = (-dx / Math.max(1, this.lanes.width)) * this.#range.span;
    this.#look(moved(this.#range, by, this.#now()));
  }

  /** Tell what is under the pointer. */
  #point(x, y, event) {
    const found = x === null ? null : this.lanes.at(x, y);
    this.#cursor = found?.at ?? null;
    if (found === null) this.tip.hide();
    else this.tip.show(found, this.#dark, this.#now(), event.clientX, event.clientY);
    this.#ask();
  }

  #press(x) {
    const found = this.lanes.at(x, 0);
    if (!found) return;
    const edge = this.#nearest(found.at);
    const isNear = edge !== null && Math.abs(xOf(this.lanes.scale, edge) - x) <= SNAP_PX;
    this.#pin(isNear ? edge : found.at);
  }

  #nearest(at) {
    const after = this.#edges.find((edge) => edge >= at);
    const before = this.#edges.findLast((edge) => edge < at);
    if (after === undefined || before === undefined) return after ?? before ?? null;
    return after - at < at - before ? after : before;
  }

  /** The lane that the keys are on, while they are. */
  #focusedLane() {
    return this.lanes.canvas.matches(":focus-visible") ? this.#lane : null;
  }

  #cursorX() {
    const { scale, width } = this.lanes;
    return this.#cursor === null || !scale ? width / 2 : xOf(scale, this.#cursor);
  }

  #focus() {
    if (!this.lanes.canvas.matches(":focus-visible")) return;
    this.#moveCursor(this.#pinned ?? this.#edges.at(-1) ?? this.#now());
  }

  #moveCursor(at) {
    this.#cursor = at;
    this.#range = showing(this.#range, at, this.#now());
    this.#draw();
    const lane = this.#lanes.find(({ key }) => key === this.#lane);
    const y = this.lanes.middleOf(this.#lane);
    const x = this.#cursorX();
    const box = this.lanes.canvas.getBoundingClientRect();
    const items = lane ? itemsAt(lane, at).filter(({ tone }) => tone !== "none") : [];
    const found = { at, lane, items };
    this.tip.show(found, this.#dark, this.#now(), box.left + x, box.top + y);
    this.#speak(this.#now());
  }

  #moveLane(way) {
    const n = this.#lanes.findIndex(({ key }) => key === this.#lane) + way;
    this.#lane = this.#lanes[Math.min(this.#lanes.length - 1, Math.max(0, n))]?.key ?? "state";
    this.#moveCursor(this.#cursor ?? this.#pinned ?? this.#now());
  }

  #toEdge(place) {
    this.#moveCursor(this.#edges.at(place) ?? this.#now());
  }

  /** To the event before or after; the panels follow if they are pinned. */
  #step(way) {
    const isPinned = this.#pinned !== null;
    const at = isPinned ? this.#pinned : (this.#cursor ?? this.#now());
    const next = way > 0 ? this.#edges.find((edge) => edge > at) : this.#edges.findLast((edge) => edge < at);
    if (next === undefined) return;
    if (document.activeElement === this.lanes.canvas) this.#moveCursor(next);
    if (isPinned) this.#pin(next, STEP_MS);
  }

  /** Ask for the state at a moment; the answer pins all panels to it. */
  async #pin(at, delayMs = 0) {
    const asked = Symbol("moment");
    const time = Math.floor(Math.min(at, this.#now()));
    [this.#asked, this.#pending] = [asked, time];
    this.#range = showing(this.#range, time, this.#now());
    this.#tell(`Loading ${timeAndDay(time)} …`);
    this.#ask();
    if (delayMs) await new Promise((resolve) => setTimeout(resolve, delayMs));
    if (asked !== this.#asked) return;
    try {
      const state = await stateAt(time, this.#view.live);
      if (asked !== this.#asked) return;
      this.#tell("");
      this.#pending = null;
      this.#dispatch({ at: time, state });
    } catch (error) {
      if (asked !== this.#asked) return;
      this.#pending = null;
      this.#tell(refusalWords(error), NOTE_MS);
      if (this.#view.moment) this.#dispatch(null);
    }
    this.#ask();
  }

  #release() {
    [this.#asked, this.#pending] = [null, null];
    this.#tell("");
    this.#dispatch(null);
  }

  #dispatch(detail) {
    this.dispatchEvent(new CustomEvent("ph-moment", { bubbles: true, detail }));
  }

  /** Whoever is back at live goes on with now. */
  #pinChanged(pinned) {
    if (pinned === null && this.#pending === null) this.#range = { ...this.#range, end: null };
    this.#ask();
  }

  #showMoment(at) {
    const time = typeof at === "number" ? at : Date.parse(at);
    if (!Number.isFinite(time) || !this.#view) return;
    this.#show("timeline");
    this.dispatchEvent(new CustomEvent("ph-tab", { bubbles: true, detail: "log" }));
    this.#pin(time);
  }

  async #save(button) {
    const { from, to } = scaleOf(this.#range, this.#now(), this.lanes.width || 1);
    const count = (n) => this.#tell(`Reading events: ${n.toLocaleString("en-GB")} …`);
    await whileSending(button, async () => {
      try {
        this.#tell(await exportEvents(from, to, count), NOTE_MS);
      } catch (error) {
        this.#tell(`Not saved: ${error.message}`, NOTE_MS);
      }
    });
  }

  #tell(text, forMs = 0) {
    setText(this.note, text);
    clearTimeout(this.noted);
    if (forMs) this.noted = setTimeout(() => setText(this.note, ""), forMs);
  }

  /** The text of the slider, for those who do not see it. */
  #speak(now) {
    const { canvas, scale } = this.lanes;
    if (!scale) return;
    const at = this.#cursor ?? this.#pinned ?? now;
    const seconds = [scale.from, scale.to, at].map((time) => Math.round(time) / 1000);
    setAttribute(canvas, "aria-valuemin", seconds[0]);
    setAttribute(canvas, "aria-valuemax", seconds[1]);
    setAttribute(canvas, "aria-valuenow", Math.min(seconds[1], Math.max(seconds[0], seconds[2])));
    const words = this.tip.text || `${timeAndDay(at)}, ${this.#range.end === null ? "follows now" : "earlier"}`;
    setAttribute(canvas, "aria-valuetext", words);
  }
}

const KEYS =
  "Left and right go to the previous and the next event, up and down to another lane, Enter shows" +
  " that moment in all panels, Escape goes back to live. Plus and minus zoom, Page Up and Page Down" +
  " move, Home goes to the first event, End to now.";

function unheard({ at }) {
  return { begin: Date.parse(at), end: Infinity, text: "no contact: not known" };
}

customElements.define("ph-timeline", Timeline);
