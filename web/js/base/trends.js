/** The last minute of each signal, in buckets of a second, filled from the frames of the stream. */

import { request } from "/web/js/base/api.js";

export const SPAN_S = 60;
const SIZE = 64;
const MOST_REQUESTS = 3;

/** One signal: the least and greatest value of each second, and whether an error was on. */
class Trend {
  constructor() {
    this.seconds = new Float64Array(SIZE).fill(-1);
    this.low = new Float64Array(SIZE);
    this.high = new Float64Array(SIZE);
    this.last = new Float64Array(SIZE);
    this.bad = new Uint8Array(SIZE);
    this.members = [];
    this.isNumber = false;
  }

  /** The value as a number: an enumeration counts from its best member, which is 0. */
  place(value) {
    if (typeof value !== "string") return Number(value);
    if (!this.members.includes(value)) this.members.push(value);
    return this.members.indexOf(value);
  }

  /** Note values of one second; those that it has already stay. */
  note(second, low, high, last, isBad) {
    const index = second % SIZE;
    if (this.seconds[index] > second) return;
    const isNew = this.seconds[index] !== second;
    this.seconds[index] = second;
    this.low[index] = isNew ? low : Math.min(this.low[index], low);
    this.high[index] = isNew ? high : Math.max(this.high[index], high);
    this.last[index] = last;
    this.bad[index] = (!isNew && this.bad[index]) || isBad ? 1 : 0;
  }

  /** Return `{low, high, last, bad}` of each second up to `end`, the oldest first; null: no value. */
  points(end) {
    const found = [];
    for (let second = end - SPAN_S + 1; second <= end; second++) {
      const index = second % SIZE;
      const isKnown = this.seconds[index] === second;
      const { low, high, last, bad } = this;
      found.push(
        isKnown
          ? { low: low[index], high: high[index], last: last[index], bad: bad[index] === 1 }
          : null,
      );
    }
    return found;
  }

  learn({ value, settings }) {
    if (value !== null) this.isNumber = typeof value === "number";
    if (settings.members && this.members.length === 0) this.members = settings.members.split(", ");
  }
}

/** The trends of all signals up to now, or up to the moment to which the page is pinned. */
class Trends {
  #trends = new Map();
  #seen = null;
  #second = 0;
  #asked = new Set();
  #waiting = [];
  #running = 0;

  /** Return the trend of a signal, and request what was before the page was opened. */
  of(name, signal, end, hasHistory) {
    const trend = this.#trend(name);
    trend.learn(signal);
    if (hasHistory && !this.#asked.has(name)) {
      this.#asked.add(name);
      this.#waiting.push([name, signal, end]);
      this.#next();
    }
    return trend;
  }

  /** Take in what a frame changed, and once a second what has not changed and still holds. */
  hear(signals, now, isLive) {
    const second = Math.floor(now / 1000);
    if (!isLive || (signals === this.#seen && second === this.#second)) return;
    const isNext = second !== this.#second;
    // A recording may go back.
    if (second < this.#second - 1) this.#trends.clear();
    for (const name in signals) {
      const signal = signals[name];
      if (!isNext && signal === this.#seen?.[name]) continue;
      if (signal.value === null || signal.stale) continue;
      const trend = this.#trend(name);
      trend.learn(signal);
      const place = trend.place(signal.value);
      trend.note(second, place, place, place, Boolean(signal.error));
    }
    this.#seen = signals;
    this.#second = second;
  }

  #trend(name) {
    let trend = this.#trends.get(name);
    if (!trend) this.#trends.set(name, (trend = new Trend()));
    return trend;
  }

  async #next() {
    if (this.#running >= MOST_REQUESTS || this.#waiting.length === 0) return;
    this.#running++;
    const [name, signal, end] = this.#waiting.shift();
    const span = { from_at: isoTime(end - SPAN_S), to_at: isoTime(end + 1), points: SPAN_S };
    const path = `/signals/${name.split("/").map(encodeURIComponent).join("/")}/history`;
    // Without a history the line begins where the page was opened.
    const history = await request("GET", `${path}?${new URLSearchParams(span)}`).catch(() => null);
    if (history) this.#fill(this.#trend(name), signal, history.items, end);
    this.#running--;
    this.#next();
  }

  /** Each value holds until the next one, or until it is stale. */
  #fill(trend, { settings }, items, end) {
    const holds_s = settings.stale_after_s || Infinity;
    items.forEach(({ at, min, max, last, error }, index) => {
      const begin = Math.floor(Date.parse(at) / 1000);
      const next = items[index + 1] ? Math.floor(Date.parse(items[index + 1].at) / 1000) : end + 1;
      const [low, high, held] = [min, max, last].map((value) => trend.place(value));
      trend.note(begin, low, high, held, Boolean(error));
      const until = Math.min(next, begin + holds_s + 1, end + 1);
      for (let s = Math.max(begin + 1, end - SPAN_S); s < until; s++)
        trend.note(s, held, held, held, Boolean(error));
    });
  }
}

function isoTime(second) {
  return new Date(second * 1000).toISOString();
}

let live = new Trends();
let pinned = { at: null, trends: null };
let epoch = null;

/** Take in a view of the page; after a restart of the service the trends begin anew. */
export function hearTrends({ live: state, contact, moment, serverNow }) {
  if (state.epoch !== epoch) {
    epoch = state.epoch;
    live = new Trends();
  }
  if (!moment) live.hear(state.signals, serverNow, contact.level !== "lost");
}

/** Return the trend of a signal as `{trend, end}`, the second with which it ends. */
export function trendOf(name, signal, { live: state, moment, serverNow, contact }) {
  const end = Math.floor(serverNow / 1000);
  // A recording has none, and without contact nobody answers.
  const hasHistory = !state.replay && contact.level !== "lost";
  if (!moment) return { trend: live.of(name, signal, end, hasHistory), end };
  if (pinned.at !== moment.at) pinned = { at: moment.at, trends: new Trends() };
  return { trend: pinned.trends.of(name, signal, end, hasHistory), end };
}
