/** <ph-signal-detail>: the history of one signal as a chart and as a table, and what is set. */

import { request } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { detailWords } from "/web/js/base/problem.js";
import { valueText } from "/web/js/base/signal_catalog.js";
import { timeOfDay } from "/web/js/base/words.js";
import { Chart, showMoment } from "/web/js/signals/chart.js";
import { factsOf, limitOf, noteOf } from "/web/js/signals/signal_facts.js";

const MINUTE_MS = 60_000;
const SPANS = [
  ["1 min", 1],
  ["10 min", 10],
  ["1 h", 60],
  ["6 h", 360],
  ["24 h", 1440],
];
const POINTS = 300;
const MOST_ROWS = 60;
const LEAST_PAUSE_MS = 1000;

/** Open the detail of a row, or close it; the one that was open in the list is closed. */
export function toggleDetail(row, view) {
  const open = row.parentElement.querySelector("ph-signal-detail");
  const last = open?.parentElement;
  if (last) {
    open.remove();
    last.detail = null;
    setAttribute(last.button, "aria-expanded", "false");
  }
  if (last === row) return;
  row.detail = el("ph-signal-detail");
  row.append(row.detail);
  row.detail.open(row.name, row.label);
  row.detail.show(view);
  setAttribute(row.button, "aria-expanded", "true");
  row.scrollIntoView({ block: "nearest" });
}

class SignalDetail extends HTMLElement {
  #span = 10;
  #askedAt = -Infinity;
  #asked = 0;
  /** The moment whose history is shown, in ms; null: now; undefined: none yet. */
  #shownAt = undefined;

  open(name, label) {
    this.name = name;
    this.chart = new Chart((value) => this.#words(value));
    this.spans = SPANS.map(([text, minutes]) =>
      el("button", { class: "small", onclick: () => this.#choose(minutes) }, text),
    );
    this.summary = el("p", { class: "quiet" }, "Loading the history …");
    this.note = el("p", { class: "signal-note" });
    this.facts = el("dl", { class: "signal-facts" });
    this.table = el("tbody");
    this.append(
      el("div", { class: "segments", role: "group", "aria-label": `${label}: time span` }, ...this.spans),
      this.chart.node,
      this.summary,
      this.note,
      this.facts,
      tableOf(label, this.table),
    );
    this.#choose(this.#span);
    if (name) this.#askMonitor();
  }

  show(view) {
    this.view = view;
    const signal = view.state.signals[this.name];
    setText(this.note, noteOf(signal));
    setAttribute(this.note, "hidden", !this.note.textContent);
    const facts = factsOf(this.name, signal, this.monitor, view.serverNow);
    renderOnce(this.facts, JSON.stringify(facts), () =>
      facts.flatMap(([name, text]) => [el("dt", {}, name), el("dd", {}, text)]),
    );
    const pause = Math.max(LEAST_PAUSE_MS, (this.#span * MINUTE_MS) / POINTS);
    if (view.live.replay) setText(this.summary, "A recording has no history.");
    const at = view.moment?.at ?? null;
    const isOld = at === null && performance.now() - this.#askedAt > pause;
    const isAnswered = view.contact.level !== "lost" && !view.live.replay;
    if (isAnswered && (isOld || at !== this.#shownAt)) this.#load(at);
  }

  #choose(minutes) {
    this.#span = minutes;
    this.#shownAt = undefined;
    SPANS.forEach(([, own], index) => setAttribute(this.spans[index], "aria-pressed", String(own === minutes)));
    if (this.view) this.show(this.view);
  }

  async #askMonitor() {
    const answer = await request("GET", "/monitors").catch(() => ({ items: [] }));
    this.monitor = answer.items.find(({ signal }) => signal === this.name) ?? null;
  }

  async #load(at) {
    this.#askedAt = performance.now();
    this.#shownAt = at;
    const to = this.view.serverNow;
    const from = to - this.#span * MINUTE_MS;
    const asked = ++this.#asked;
    const path = this.name.split("/").map(encodeURIComponent).join("/");
    const [from_at, to_at] = [from, to].map((at) => new Date(at).toISOString());
    const query = new URLSearchParams({ from_at, to_at, points: POINTS });
    try {
      const history = await request("GET", `/signals/${path}/history?${query}`);
      if (asked === this.#asked && this.isConnected) this.#draw(history, from, to);
    } catch (error) {
      // What was asked for changes nothing, whether it was answered or not.
      const why = error.problem.status ? detailWords(error.problem) : "the service did not answer";
      setText(this.summary, `No history: ${why.replace(/\.$/, "")}.`);
    }
  }

  #draw({ items, tier_s }, from, to) {
    const { settings, value } = this.view.state.signals[this.name];
    const members = settings.members?.split(", ");
    this.scale = members ?? (typeof value === "boolean" ? [false, true] : null);
    const place = (shown) => (members ? members.indexOf(shown) : Number(shown));
    const points = items.map(({ at, min, max, mean, last, error }) => ({
      at: Math.max(from, Date.parse(at)),
      low: place(min),
      high: place(max),
      mid: this.scale ? place(last) : mean,
      isBad: Boolean(error),
    }));
    const step = Math.max(tier_s * 1000, (to - from) / POINTS);
    const gap = settings.stale_after_s ? settings.stale_after_s * 1000 + 2.5 * step : Infinity;
    this.chart.draw({ points: held(points, to, gap), from, to, limit: limitOf(settings), gap });
    this.#tell(points, items);
  }

  /** The value as an operator reads it; members of an enumeration are placed by their number. */
  #words(value) {
    const signal = this.view.state.signals[this.name];
    return valueText(this.name, signal, this.scale ? (this.scale[Math.round(value)] ?? null) : value);
  }

  #tell(points, items) {
    const least = Math.min(...points.map(({ low }) => low));
    const most = Math.max(...points.map(({ high }) => high));
    const span = SPANS.find(([, minutes]) => minutes === this.#span)[0];
    const words =
      least === most
        ? `${this.#words(least)} all the time in ${span}`
        : `${this.#words(least)} to ${this.#words(most)} in ${span}`;
    setText(this.summary, points.length ? words : `No reading in ${span}.`);
    const each = Math.ceil(points.length / MOST_ROWS);
    renderOnce(this.table, items.at(-1)?.at + this.#span, () =>
      points
        .map((point, index) => [point, items[index]])
        .filter((_, index) => index % each === 0)
        .map(([{ low, high, mid }, { at, error }]) =>
          el("tr", {}, timeCell(at), ...[low, high, mid].map((v) => cell(this.#words(v))), cell(error ?? "")),
        ),
    );
  }
}

/** A value holds until now, unless it is stale. */
function held(points, to, gap) {
  const last = points.at(-1);
  return last && to - last.at < gap ? [...points, { ...last, at: to }] : points;
}

function timeCell(at) {
  const show = ({ target }) => showMoment(target, Date.parse(at));
  const title = `Show ${timeOfDay(at)} in all panels`;
  return el("td", {}, el("button", { title, onclick: show }, timeOfDay(at)));
}

function cell(text) {
  return el("td", {}, text);
}

function tableOf(label, body) {
  const head = ["Time", "Least", "Greatest", "Value", "Error"].map((text) => el("th", { scope: "col" }, text));
  return el(
    "details",
    {},
    el("summary", {}, "As a table"),
    el(
      "table",
      {},
      el("caption", { class: "visually-hidden" }, `${label}: history`),
      el("thead", {}, el("tr", {}, ...head)),
      body,
    ),
  );
}

customElements.define("ph-signal-detail", SignalDetail);
