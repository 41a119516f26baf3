/** The events that the timeline shows: those of the log, and those of the stream as they come. */

import { request } from "/web/js/base/api.js";
import { emptyState, fold } from "/web/js/base/store.js";
import { commonGroups, groupOfPart } from "/web/js/timeline/event_groups.js";

const PAGE = 1000;
/** Of one group; a span with more shows only the newest. */
export const MOST_EVENTS = 3000;
const KEPT_EVENTS = 2 * MOST_EVENTS;
const RETRY_MS = 10_000;
const FRAME_MS = 60_000;

export class EventRecord {
  #groups = commonGroups();
  #tell;
  #heard = null;
  #epoch = null;
  #lastFrameAt = 0;
  #runEnds = new Map();
  #seed = null;
  #seedAskedFor = null;
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
      for (const group of Object.values(this.#groups)) isNew = take(group, event) || isNew;
    if (isNew) this.version += 1;
  }

  /** What `lanesOf` takes: all that is known from `from` on. */
  known(from, live) {
    const seed = this.#seed?.at === from ? this.#seed.state : null;
    return { from, groups: this.#groups, dark: this.#dark(from), seed, live };
  }

  /** The time from which all groups are loaded, but for those of parts. */
  get from() {
    const groups = Object.entries(this.#groups).filter(([name]) => !name.startsWith("part:"));
    return Math.max(-Infinity, ...groups.map(([, { isFull, from }]) => (isFull ? -Infinity : from)));
  }

  /** Ask for the state at `from`, which only a run that ended before now does not tell. */
  async loadSeed(from) {
    const hasEnds = this.restarts().some(({ end }) => end > from);
    const isBefore = this.#beginAt !== null && this.#beginAt > from;
    if (!hasEnds || isBefore || this.#seedAskedFor === from) return;
    this.#seedAskedFor = from;
    const path = `/frames?at=${new Date(from).toISOString()}`;
    try {
      const frame = await request("GET", path, undefined, { timeoutMs: FRAME_MS });
      this.#seed = { at: from, state: fold(emptyState(), frame) };
      this.#changed();
    } catch {
      // Without it what was before the first event stays hatched, as not known.
    }
  }

  /** Between the last event of a run and the first of the next nothing is known. */
  restarts() {
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
      if (end === undefined) this.#loadRunEnd(before.epoch, run.first);
      return { begin: Math.max(before.end, end ?? 0), end: run.begin, isRestart: true };
    });
  }

  #dark(from) {
    const dark = this.restarts().filter(({ end }) => end > from);
    for (const gap of dark) gap.text = "the service did not run, or nothing was recorded";
    if (this.#beginAt !== null && this.#beginAt > from)
      dark.unshift({ begin: -Infinity, end: this.#beginAt, text: "nothing is recorded of this time" });
    return dark;
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
    const found = [];
    try {
      while (found.length < MOST_EVENTS) {
        const end = before === undefined ? "" : `&before=${before}`;
        const begin = new Date(Math.floor(from)).toISOString();
        const path = `/events?${group.query}&from_at=${begin}&limit=${PAGE}${end}`;
        const { items } = await request("GET", path);
        found.unshift(...items);
        if (items.length < PAGE) break;
        before = items[0].id;
      }
      group.isFull = found.length >= MOST_EVENTS;
      group.from = group.isFull ? Date.parse(found[0].at) : from;
      const last = found.at(-1)?.id ?? 0;
      group.events = [...found, ...group.events.filter(({ id }) => id > last)];
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

/** Add an event to the group that shows it; the oldest are dropped from one that grew too large. */
function take(group, event) {
  if (!group.takes(event) || group.events.at(-1)?.id >= event.id) return false;
  group.events.push(event);
  if (group.events.length > KEPT_EVENTS) {
    group.events = group.events.slice(-MOST_EVENTS);
    group.from = Date.parse(group.events[0].at);
    group.isFull = true;
  }
  return true;
}
