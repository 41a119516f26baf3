/** What happened, as intervals on lanes: pure functions. Times are in ms since 1970.
 *
 * A record is what is known: `{from, groups: {name: {events, from}}, dark, runBegin, live}`. `dark` are
 * times of which nothing is known, in order: the service did not run, or its events were lost. A
 * value is never carried across one of them. Events between `runBegin` and `from` tell how it was at
 * `from`; `live` is the state now. An interval is `{begin, end, text, tone}`; one that lasts has `end` Infinity, and one of which
 * the begin was not seen is `cut`.
 */

import { commandOf } from "/web/js/timeline/commands.js";
import { label } from "/web/js/base/words.js";

const SYSTEM_TONES = { IDLE: "rest", RUNNING: "active", ERROR: "alarm" };
const NO_TASK = { text: "no task", tone: "none" };
const TASK_NOW = { RUNNING: "running", PAUSING: "stopping", PAUSED: "paused" };
const TASK_STATUS = {
  "task.served": "accepted",
  "task.started": "running",
  "task.resumed": "running",
  "task.pausing": "stopping",
  "task.paused": "paused",
};
/** What a task was right before an event; of the others it is not known. */
const TASK_BEFORE = {
  "task.started": "accepted",
  "task.resumed": "paused",
  "task.pausing": "running",
  "task.succeeded": "running",
};
const TASK_TONES = { accepted: "rest", running: "active", stopping: "warn", paused: "warn" };
const ENDS = { "task.succeeded": "succeeded", "task.canceled": "canceled", "task.aborted": "aborted" };
const SEVERE = ["critical", "fatal"];
const AT_REST = ["inactive", "unconfigured", "finalized"];

/** Return the lanes of a record, those of `parts` before the commands. */
export function lanesOf(record, parts) {
  return [
    stateLane(record),
    taskLane(record),
    errorLane(record),
    holdLane(record),
    ...parts.map((part) => partLane(record, part)),
    commandLane(record),
  ];
}

/** Times of which something is known; the last one goes on to now, or to the last contact. */
export function knownTimes({ from, dark }) {
  const times = [];
  let begin = from;
  for (const gap of dark) {
    if (gap.begin > begin) times.push({ begin, end: gap.begin });
    begin = Math.max(begin, gap.end);
  }
  if (begin < Infinity) times.push({ begin, end: Infinity });
  if (times.length) times.at(-1).isLast = true;
  return times;
}

/** One value at a time. A change is `{at, value, was}`; `undefined` is a value that is not known. */
export function valueLane(record, group, changes, current) {
  const lane = { intervals: [], unknown: [] };
  for (const time of knownTimes(record)) {
    const begin = shownFrom(lane, time, group);
    const own = changes.filter(({ at }) => at >= begin && at <= time.end);
    const before = changes.findLast((change) => isBefore(record, begin, change.at));
    const lasts = own.length === 0 && time.isLast;
    let [at, value] = [begin, before ? before.value : lasts ? current : own[0]?.was];
    for (const change of own) {
      // What lasted less than a millisecond was there all the same.
      if (change.at > at || change !== own[0]) put(lane, at, change.at, value);
      if (change.point) lane.intervals.push({ begin: change.at, end: change.at, ...change.point });
      [at, value] = [change.at, change.value];
    }
    if (time.end > at) put(lane, at, time.end, value);
  }
  return lane;
}

/** Whether a time is in the same run as a begin of the record, and before it. */
function isBefore(record, begin, at) {
  return begin === record.from && at >= record.runBegin && at < begin;
}

/** Any number at a time, each with a key. An act is `{at, key, value}`; without value it ends. */
export function spanLane(record, group, acts, current) {
  const lane = { intervals: [], unknown: [] };
  for (const time of knownTimes(record)) {
    const begin = shownFrom(lane, time, group);
    const open = new Map();
    for (const act of acts) {
      if (isBefore(record, begin, act.at)) {
        if (act.value) open.set(act.key, { begin, cut: true, ...act.value });
        else open.delete(act.key);
      }
      if (act.at < begin || act.at > time.end) continue;
      const was = open.get(act.key) ?? { begin, cut: true, ...act.was };
      const isOn = open.delete(act.key);
      if (isOn || !act.value) lane.intervals.push({ ...was, end: act.at });
      if (act.value) open.set(act.key, { begin: act.at, ...act.value });
    }
    if (time.isLast) addCurrent(open, current, begin);
    const lost = time.end !== Infinity;
    for (const one of open.values()) lane.intervals.push({ ...one, end: time.end, lost });
  }
  lane.intervals.sort((a, b) => a.begin - b.begin);
  return lane;
}

/** What is on now, and of which the begin is not among the events. */
function addCurrent(open, current, begin) {
  for (const [key, { since, ...value }] of current) {
    if (open.has(key)) continue;
    open.set(key, { begin: Math.max(begin, since), cut: since < begin, ...value });
  }
}

/** From where a group is known within `time`; what is before that is not loaded. */
function shownFrom(lane, { begin, end }, { from, isFull }) {
  const known = Math.min(Math.max(begin, from), end);
  const text = isFull ? "not loaded: too many events" : "loading";
  if (known > begin) lane.unknown.push({ begin, end: known, text });
  return known;
}

function put(lane, begin, end, value) {
  if (value === undefined) {
    lane.unknown.push({ begin, end, text: "not known" });
    return;
  }
  const last = lane.intervals.at(-1);
  const goesOn = last && last.end === begin && last.text === value.text && last.begin < begin;
  if (goesOn) last.end = end;
  else lane.intervals.push({ begin, end, ...value });
}

function stateLane({ live, groups, ...record }) {
  const changes = groups.state.events.map(({ at, data }) => ({
    at: Date.parse(at),
    value: systemValue(data.state, data.errors),
    was: systemValue(data.was),
  }));
  const { systemState } = live;
  const now = systemState ? systemValue(systemState.state, systemState.errors) : undefined;
  return { key: "state", name: "State", ...valueLane(record, groups.state, changes, now) };
}

function systemValue(state, errors = []) {
  const text = errors.length ? `${state}: ${errors.join(", ")}` : state;
  return { text, tone: SYSTEM_TONES[state] ?? "rest", short: state };
}

function taskLane({ live, groups, ...record }) {
  const changes = [];
  for (const { kind, at, data } of groups.task.events) {
    const change = taskChange(kind, data);
    if (change) changes.push({ at: Date.parse(at), ...change });
  }
  const lane = valueLane(record, groups.task, changes, taskNow(live));
  return { key: "task", name: "Task", ...lane };
}

function taskChange(kind, { task, reason }) {
  const before = TASK_BEFORE[kind];
  const was = kind === "task.served" ? NO_TASK : before ? taskValue(task, before) : undefined;
  if (TASK_STATUS[kind]) return { value: taskValue(task, TASK_STATUS[kind], reason), was };
  if (!ENDS[kind]) return null;
  const tone = kind === "task.aborted" ? "warn" : "busy";
  return { value: NO_TASK, was, point: { ...taskValue(task, ENDS[kind], reason), tone } };
}

function taskValue(task, status, reason) {
  const why = reason ? `: ${reason}` : "";
  const tone = TASK_TONES[status];
  return { text: `task ${task} ${status}${why}`, short: `${task} ${status}`, tone };
}

function taskNow({ task }) {
  if (!task || task.ended_at) return NO_TASK;
  return taskValue(task.id, TASK_NOW[task.status] ?? task.status, task.reason);
}

/** Errors from which others follow; those stand in the words of Why. */
function errorLane({ live, groups, ...record }) {
  const acts = [];
  for (const { kind, at, data } of groups.errors.events) {
    const isRaised = kind === "error.raised";
    if (data.root_cause === false || !(isRaised || kind === "error.cleared")) continue;
    const known = live.errors[nameOfError(data)];
    const was = errorValue({ ...known, ...data });
    acts.push({ at: Date.parse(at), key: nameOfError(data), value: isRaised ? was : null, was });
  }
  const lane = spanLane(record, groups.errors, acts, errorsOn(live));
  return { key: "errors", name: "Errors", ...lane };
}

function errorsOn({ errors }) {
  const isOn = ({ state: is, root_cause }) =>
    root_cause && ["active", "acknowledged", "latched"].includes(is);
  const on = Object.values(errors).filter(isOn);
  return on.map((error) => [
    nameOfError(error),
    { since: Date.parse(error.since_at), ...errorValue(error) },
  ]);
}

function nameOfError({ part, error }) {
  return part ? `${part}.${error}` : error;
}

/** Only an error of the robot itself, or a severe one, is red. */
function errorValue(error) {
  const name = nameOfError(error);
  const isSevere = error.severity ? SEVERE.includes(error.severity) : !error.part;
  const tone = error.silenced || error.suppressed ? "busy" : isSevere ? "alarm" : "warn";
  return { text: error.message ? `${name}: ${error.message}` : name, short: name, tone };
}

function holdLane({ live, groups, ...record }) {
  const acts = [];
  for (const { kind, at, data } of groups.holds.events) {
    if (kind !== "hold.set" && kind !== "hold.released") continue;
    const was = holdValue(data);
    const value = kind === "hold.set" ? was : null;
    acts.push({ at: Date.parse(at), key: data.owner, value, was });
  }
  const lane = spanLane(record, groups.holds, acts, holdsOn(live));
  return { key: "holds", name: "Holds", ...lane };
}

function holdsOn({ holds }) {
  return Object.values(holds).map((hold) => [hold.owner, { since: Date.parse(hold.since_at), ...holdValue(hold) }]);
}

/** A hold of an error says no more than its error does, which has a lane of its own. */
function holdValue({ owner, reason }) {
  const tone = owner === "error" ? "busy" : "warn";
  return { text: `hold ${owner}${reason ? `: ${reason}` : ""}`, short: owner, tone };
}

function partLane({ live, groups, ...record }, part) {
  const group = groups[`part:${part}`] ?? { events: [], from: Infinity };
  const changes = group.events.map(({ at, data }) => ({
    at: Date.parse(at),
    value: partValue(data.actual, data.reason),
    was: partValue(data.was),
  }));
  const actual = live.parts[part]?.actual;
  const now = actual?.mode ? `${actual.state}.${actual.mode}` : actual?.state;
  const current = now === undefined ? undefined : partValue(now);
  return { key: `part:${part}`, name: part, ...valueLane(record, group, changes, current) };
}

function partValue(actual, reason) {
  const dot = actual.indexOf(".");
  const [state, mode] = dot < 0 ? [actual, null] : [actual.slice(0, dot), actual.slice(dot + 1)];
  const words = label({ state, mode });
  const text = state === "unknown" ? "state unknown" : words;
  return { text: reason ? `${text}: ${reason}` : text, short: words, tone: partTone(state) };
}

function partTone(state) {
  if (state === "unknown") return "unknown";
  if (state === "errorprocessing") return "alarm";
  if (state === "active") return "active";
  return AT_REST.includes(state) ? "rest" : "busy";
}

function commandLane({ groups, ...record }) {
  const { requests, stops, audit, errors } = groups;
  const all = [requests, stops, audit, errors].flatMap(({ events }) => events);
  const intervals = [];
  for (const event of all) {
    const command = commandOf(event);
    const at = Date.parse(event.at);
    if (command && at >= record.from) intervals.push({ begin: at, end: at, ...command });
  }
  intervals.sort((a, b) => a.begin - b.begin);
  const lane = { intervals, unknown: [] };
  const shorter = requests.from > audit.from ? requests : audit;
  for (const time of knownTimes(record)) shownFrom(lane, time, shorter);
  return { key: "commands", name: "Commands", ...lane };
}
