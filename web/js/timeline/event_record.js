/** The events that the timeline shows: those of the log, and those of the stream as they come. */

import { request } from "/web/js/base/api.js";
import { commonGroups, groupOfPart } from "/web/js/timeline/event_groups.js";

const [FIRST_PAGE, PAGE] = [200, 1000];
/** So many of those before the shown time tell how it was when that began. */
const EARLIER = 200;
/** Of one group; a span with more shows only the newest. */
export const MOST_EVENTS = 3000;
const KEPT_EVENTS = 2 * MOST_EVENTS;
const RETRY_MS = 10_000;

export class EventRecord {
  #groups = commonGroups();
  #tell;
  #heard = null;
  #epoch = null;
  #lastFrameAt = 0;
  #runEnds = new Map();
  #beginAt = null;
  #blockedUntil = 0;
  /** Why something could not be loaded; empty if it was. */
  problem = "";
  /** Rises with each change of what is known. */
  version = 0;

  /** @param tell Called when something was loaded. */
  constructor(tell) {
    this.#tell = tell;
  }

  get isLoading() {
    return Object.values(this.#groups).some(({ isLoading }) => isLoading);
  }

  /** Whether a group has more events in its span than are loaded. */
  get isCut() {
    return Object.values(this.#groups).some(({ isFull }) => isFull);
  }

  /** Load what is missing from `from` on, of all groups and of `parts`. */
  load(from, parts) {
    for (const part of parts) this.#groups[`part:${part}`] ??= groupOfPart(part);
    this.#forgetParts(parts);
    if (Date.now() < this.#blockedUntil) return;
    if (this.#beginAt === null) this.#loadBegin();
    for (const group of Object.values(this.#groups))
      if (isWanting(group, from)) this.#loadGroup(group, from);
  }

  /** Take the events of the stream since the last call. */
  hear({ events, epoch, boot, at, lastEventId }) {
    if (epoch !== this.#epoch) this.#beginRun(epoch, boot, at);
    else if (at) this.#lastFrameAt = Date.parse(at);
    this.#heard ??= lastEventId;
    const fresh = [];
    let n = events.length - 1;
    for (; n >= 0 && !events[n].isRestart && !(events[n].id <= this.#heard); n -= 1)
      if (events[n].kind) fresh.push(events[n]);
    if (fresh.length === 0) return;
    const wasMissed = n < 0 && fresh.at(-1).id > this.#heard + 1;
    this.#heard = fresh[0].id;
    if (wasMissed) this.#reload();
    let isNew = false;
    for (const event of fresh.reverse())
      for (const group of Object.values(this.#groups)) isNew = append(group, event) || isNew;
    if (isNew) this.version += 1;
  }

  /** What `lanesOf` takes: all that is known from `from` on. */
  known(from, live) {
    const restarts = this.#restarts(from);
    const begins = restarts.filter(({ end }) => end <= from).map(({ end }) => end);
    const dark = restarts.filter(({ end }) => end > from);
    const text = "nothing is recorded of this time";
    if (this.#beginAt > from) dark.unshift({ begin: -Infinity, end: this.#beginAt, text });
    return { from, groups: this.#groups, dark, live, runBegin: Math.max(-Infinity, ...begins) };
  }

  /** The time from which all groups are loaded, but for those of parts. */
  get from() {
    const groups = Object.entries(this.#groups).filter(([name]) => !name.startsWith("part:"));
    return Math.max(-Infinity, ...groups.map(([, { isFull, from }]) => (isFull ? -Infinity : from)));
  }

  /** Between the last event of a run and the first of the next nothing is known. */
  #restarts(from) {
    const runs = new Map();
    for (const { events } of Object.values(this.#groups))
      for (const { epoch, at, id } of events) {
        const time = Date.parse(at);
        const run = runs.get(epoch) ?? { epoch, first: id, begin: time, end: time };
        if (id < run.first) [run.first, run.begin] = [id, time];
        run.end = Math.max(run.end, time);
        runs.set(epoch, run);
      }
    const inOrder = [...runs.values()].sort((a, b) => a.first - b.first);
    return inOrder.slice(1).map((run, n) => {
      const before = inOrder[n];
      const end = this.#runEnds.get(before.epoch);
      if (end === undefined && run.begin > from) this.#loadRunEnd(before.epoch, run.first);
      const text = "the service did not run, or nothing was recorded";
      return { begin: Math.max(before.end, end ?? 0), end: run.begin, isRestart: true, text };
    });
  }

  /** Without a folder of data each run begins the log anew. */
  #beginRun(epoch, boot, at) {
    if (this.#epoch !== null && this.#lastFrameAt)
      this.#runEnds.set(this.#epoch, this.#lastFrameAt);
    if (this.#epoch !== null && boot === 1) {
      this.#groups = commonGroups();
      this.#beginAt = null;
      this.#heard = 0;
    }
    this.#epoch = epoch;
    this.#lastFrameAt = at ? Date.parse(at) : 0;
    this.version += 1;
  }

  async #loadGroup(group, from) {
    let before = group.isStale ? undefined : group.events[0]?.id;
    Object.assign(group, { isLoading: true, isStale: false });
    let found = [];
    try {
      for (let limit = FIRST_PAGE; ; limit = PAGE) {
        const end = before === undefined ? "" : `&before=${before}`;
        const { items } = await request("GET", `/events?${group.query}&limit=${limit}${end}`);
        found = [...items, ...found];
        if (items.length < limit || timeOf(items[0]) < from || found.length >= MOST_EVENTS) break;
        before = items[0].id;
      }
      take(group, found, from);
      this.problem = "";
    } catch (error) {
      this.problem = error.message;
      this.#blockedUntil = Date.now() + RETRY_MS;
    }
    group.isLoading = false;
    this.#changed();
  }

  async #loadBegin() {
    this.#beginAt = -Infinity;
    const { items } = await request("GET", "/events?after=0&limit=1").catch(() => ({ items: [] }));
    if (items.length) this.#beginAt = Date.parse(items[0].at);
    this.#changed();
  }

  /** The last event of a run, of whatever kind. */
  async #loadRunEnd(epoch, next) {
    this.#runEnds.set(epoch, 0);
    const path = `/events?before=${next}&limit=1`;
    const { items } = await request("GET", path).catch(() => ({ items: [] }));
    if (items[0]?.epoch !== epoch) return;
    this.#runEnds.set(epoch, Date.parse(items[0].at));
    this.#changed();
  }

  /** More came at once than the page keeps: read them from the log. */
  #reload() {
    if (Date.now() < this.#blockedUntil) return;
    this.#blockedUntil = Date.now() + RETRY_MS;
    for (const group of Object.values(this.#groups)) group.isStale = true;
    setTimeout(() => this.#changed(), RETRY_MS);
  }

  #forgetParts(parts) {
    const wanted = new Set(parts.map((part) => `part:${part}`));
    for (const name of Object.keys(this.#groups))
      if (name.startsWith("part:") && !wanted.has(name)) delete this.#groups[name];
  }

  #changed() {
    this.version += 1;
    this.#tell();
  }
}

function isWanting({ from, isFull, isStale, isLoading }, wanted) {
  return !isLoading && (isStale || (from > wanted && !isFull));
}

function timeOf({ at }) {
  return Date.parse(at);
}

/** Put what was loaded before what came meanwhile. */
function take(group, found, from) {
  const last = found.at(-1)?.id ?? 0;
  const first = Math.max(0, found.findIndex((event) => timeOf(event) >= from) - EARLIER);
  const isAll = found.length < MOST_EVENTS || timeOf(found[0]) < from;
  group.isFull = !isAll;
  group.from = isAll ? from : timeOf(found[0]);
  group.events = [...found.slice(first).filter(group.takes), ...group.events.filter(({ id }) => id > last)];
}

/** Add an event to the group that shows it; the oldest are dropped from one that grew too large. */
function append(group, event) {
  if (!group.takes(event) || group.events.at(-1)?.id >= event.id) return false;
  group.events.push(event);
  if (group.events.length > KEPT_EVENTS) {
    group.events = group.events.slice(-MOST_EVENTS);
    group.from = timeOf(group.events[0]);
    group.isFull = true;
  }
  return true;
}
