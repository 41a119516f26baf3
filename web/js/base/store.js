/** The known state of the robot, as a pure fold of the frames of the stream.
 *
 * `fold(state, message)` returns the next state and does not change the given one. Besides the
 * frames of the server it takes messages of the page: `log` (the newest of /events), `earlier` (those
 * before the oldest that is known), `path` (waypoints of a task), `latch` (the answer to a press of
 * STOP), `replay` (how a recording is to go on) and `restart_read` (the notice was dismissed).
 */

import { isOn } from "/web/js/base/error_groups.js";

const EVENTS_KEPT = 200;
const MAX_EVENTS_KEPT = 5000;

/** The state before the first frame: nothing is known. */
export function emptyState() {
  return {
    epoch: null,
    boot: null,
    restartedAt: null,
    isResumed: false,
    at: null,
    systemState: null,
    parts: {},
    signals: {},
    errors: {},
    task: null,
    path: null,
    vehicle: null,
    holds: {},
    reactions: {},
    devices: {},
    ownDevice: null,
    emergencyStop: null,
    events: [],
    eventsKept: EVENTS_KEPT,
    oldestEventId: 1,
    lastEventId: 0,
    replay: null,
  };
}

/** Return the state that follows from `state` and one message. */
export function fold(state, message) {
  const folder = FOLDERS[message.type];
  return folder ? folder(state, message) : state;
}

/** The task that has not ended, or null; `state.task` may also be the last one that ended. */
export function currentTask({ task }) {
  return task && !task.ended_at ? task : null;
}

/** The errors of a part that are on, in the order in which they were told. */
export function errorsOf({ errors }, part) {
  return Object.values(errors).filter((error) => error.part === part && isOn(error));
}

/** Id of the oldest known event, or null: there is none, or its run is not kept. */
export function firstEventId({ events }) {
  if (events.some((event) => event.isRestart)) return null;
  return events.find((event) => !event.note)?.id ?? null;
}

const FOLDERS = {
  /** After a restart of the service the earlier state is void, and told anew. Errors that ended
   * without contact are not told: the next frame has all that are on, and replaces those known.
   *
   * The first run of a folder has boot 1: then nothing was kept, and ids begin again.
   */
  hello(state, { epoch, boot, started_at, newest, replay = null }) {
    if (epoch === state.epoch) return { ...state, isResumed: true, replay };
    if (state.epoch === null) return { ...state, epoch, boot, lastEventId: newest, replay };
    const { events, eventsKept, oldestEventId, lastEventId } = state;
    const fresh = { ...emptyState(), epoch, boot, restartedAt: started_at, replay };
    if (boot > 1) return { ...fresh, events, eventsKept, oldestEventId, lastEventId };
    const note = {
      note: "The service was restarted: earlier tasks and holds are gone.",
      id: `restart-${epoch}`,
      isRestart: true,
    };
    return { ...fresh, events: [...events, note].slice(-eventsKept), eventsKept };
  },

  replay(state, { replay }) {
    return { ...state, replay };
  },

  restart_read(state) {
    return { ...state, restartedAt: null };
  },

  /** Frames carry changes; the first one, and the first after a loss, carry everything. */
  state(state, frame) {
    const errors = state.isResumed ? {} : state.errors;
    return {
      ...state,
      isResumed: false,
      at: frame.at,
      systemState: frame.system_state ?? state.systemState,
      parts: frame.parts ? { ...state.parts, ...frame.parts } : state.parts,
      signals: frame.signals ? { ...state.signals, ...frame.signals } : state.signals,
      errors: frame.errors ? withoutEnded({ ...errors, ...frame.errors }) : errors,
      reactions: frame.reactions ? { ...state.reactions, ...frame.reactions } : state.reactions,
      devices: frame.devices ? { ...state.devices, ...frame.devices } : state.devices,
      ownDevice: frame.this_device ?? state.ownDevice,
      task: frame.task === undefined ? state.task : frame.task,
      vehicle: frame.vehicle ?? state.vehicle,
      holds: frame.holds ?? state.holds,
      emergencyStop: newerStop(state.emergencyStop, frame),
    };
  },

  event(state, event) {
    if (event.id <= state.lastEventId) return state;
    return { ...append(state, event), lastEventId: event.id };
  },

  /** The log is requested once; events of the stream may arrive before the answer. */
  log(state, { items, gaps = [], oldest = 1 }) {
    const begin = state.events.findLastIndex((event) => event.isRestart) + 1;
    const streamed = state.events.slice(begin);
    const known = new Set(streamed.map((event) => event.id));
    const older = inOrder(items, gaps).filter((event) => !known.has(event.id));
    const lastEventId = Math.max(state.lastEventId, ...items.map((event) => event.id));
    const events = [...state.events.slice(0, begin), ...older, ...streamed].slice(-state.eventsKept);
    return { ...state, lastEventId, events, oldestEventId: oldest };
  },

  /** What is loaded is kept in addition, so that new events do not push it out at once. */
  earlier(state, { items, gaps, oldest }) {
    const first = firstEventId(state);
    const older = inOrder(items, gaps).filter((event) => !(event.id >= first));
    const eventsKept = Math.min(state.eventsKept + older.length, MAX_EVENTS_KEPT);
    const events = [...older, ...state.events].slice(-eventsKept);
    return { ...state, events, eventsKept, oldestEventId: oldest };
  },

  /** Without `to` the ids belong to a run that the service does not know; others follow. */
  gap(state, gap) {
    const lastEventId = gap.to ? Math.max(gap.to, state.lastEventId) : 0;
    return { ...append(state, noteOf(gap)), lastEventId };
  },

  /** A frame may tell of the press and of the standstill before the answer to the press comes. */
  latch(state, { latch }) {
    const known = state.emergencyStop?.since_at;
    const isTold = known && Date.parse(known) >= Date.parse(latch.since_at);
    return isTold ? state : { ...state, emergencyStop: latch };
  },

  path(state, { task, items, indices }) {
    return { ...state, path: { task, items, indices } };
  },
};

/** An error that ended is told once more, as normal; one that is shelved stays listed. */
function withoutEnded(errors) {
  const isOpen = ([, error]) => error.state !== "normal" || Boolean(error.shelved_until_at);
  return Object.fromEntries(Object.entries(errors).filter(isOpen));
}

/** A frame that was sent before the answer to STOP holds the earlier state. */
function newerStop(known, { at, emergency_stop }) {
  const isOld = known?.since_at && Date.parse(at) < Date.parse(known.since_at);
  return !emergency_stop || isOld ? known : emergency_stop;
}

function append(state, item) {
  return { ...state, events: [...state.events, item].slice(-state.eventsKept) };
}

function noteOf({ from, to }) {
  const which = to ? `Events ${from} to ${to}` : `Events after ${from - 1}`;
  return { note: `${which} are missing here.`, id: `gap-${from}`, from };
}

/** Events and notes for what is missing between them. */
function inOrder(items, gaps) {
  const place = (item) => item.from ?? item.id;
  return [...items, ...gaps.map(noteOf)].sort((a, b) => place(a) - place(b));
}
