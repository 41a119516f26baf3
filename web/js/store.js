/** What is known of the robot, as a pure fold of the frames of the stream.
 *
 * `fold(state, message)` returns the next state and never changes the one given. Besides the frames
 * of the server it takes messages of our own, made from answers to requests: `structure` (`items`
 * of /systems and /nodes), `log` (`items` of /events), `emergency_stop`, `holds` (`items` of
 * /holds), `path` (waypoints of a task) and `ended_task`.
 */

const EVENTS_KEPT = 200;

/** What is known before the first frame: nothing. */
export function emptyState() {
  return {
    epoch: null,
    at: null,
    systemState: null,
    parts: {},
    signals: {},
    task: null,
    lastTask: null,
    path: null,
    vehicle: null,
    holds: [],
    emergencyStop: null,
    events: [],
    lastEventId: 0,
  };
}

/** Return the state that follows from `state` and one message. */
export function fold(state, message) {
  const folder = FOLDERS[message.type];
  return folder ? folder(state, message) : state;
}

const FOLDERS = {
  hello(state, { epoch }) {
    if (epoch === state.epoch) return state;
    if (state.epoch === null) return { ...state, epoch };
    const note = { note: "The server was restarted; what follows is new.", id: `restart-${epoch}` };
    return { ...emptyState(), epoch, events: keep([...state.events, note]) };
  },

  state(state, frame) {
    return {
      ...state,
      at: frame.at,
      systemState: frame.system_state ?? state.systemState,
      parts: frame.parts ? foldParts(state.parts, frame.parts, frame.at) : state.parts,
      signals: frame.signals ? foldSignals(state.signals, frame.signals, frame.at) : state.signals,
      vehicle: frame.vehicle ?? state.vehicle,
      ...(frame.task === undefined ? {} : foldTask(state, frame.task)),
    };
  },

  event(state, event) {
    if (event.id <= state.lastEventId) return state;
    return { ...state, lastEventId: event.id, events: keep([...state.events, event]) };
  },

  /** The log is asked for once; events of the stream may have come before the answer did. */
  log(state, { items }) {
    const begin = state.events.findLastIndex((event) => event.note) + 1;
    const streamed = state.events.slice(begin);
    const known = new Set(streamed.map((event) => event.id));
    const older = items.filter((event) => !known.has(event.id)).sort((a, b) => a.id - b.id);
    const lastEventId = Math.max(state.lastEventId, ...items.map((event) => event.id));
    const events = keep([...state.events.slice(0, begin), ...older, ...streamed]);
    return { ...state, lastEventId, events };
  },

  /** Without `to` nobody knows how many: the server was restarted meanwhile, and ids begin anew. */
  gap(state, { from, to }) {
    const which = to ? `Events ${from} to ${to} are` : `Whatever followed event ${from - 1} is`;
    const note = { note: `${which} missing here.`, id: `gap-${from}` };
    const lastEventId = to ? Math.max(to, state.lastEventId) : state.lastEventId;
    return { ...state, lastEventId, events: keep([...state.events, note]) };
  },

  /** A part that was streamed is newer than any answer, and whole. */
  structure(state, { items }) {
    const parts = {};
    for (const item of items) parts[item.name] = state.parts[item.name] ?? item;
    return { ...state, parts };
  },

  emergency_stop(state, { latch }) {
    return { ...state, emergencyStop: latch };
  },

  holds(state, { items }) {
    return { ...state, holds: items };
  },

  path(state, { task, items, indices }) {
    return { ...state, path: { task, items, indices } };
  },

  /** How a task ended is told by no frame. */
  ended_task(state, { task }) {
    return { ...state, lastTask: task };
  },
};

/** A task that is no longer the current one is the last, known as it was until its end is told. */
function foldTask(state, task) {
  const isOther = state.task !== null && state.task.id !== task?.id;
  return { task, lastTask: isOther ? state.task : state.lastTask };
}

function keep(events) {
  return events.slice(-EVENTS_KEPT);
}

/** Frames carry the changed parts only, and may leave out what the structure told once. */
function foldParts(parts, changed, at) {
  const next = { ...parts };
  for (const [name, part] of Object.entries(changed)) {
    const before = parts[name];
    const since = part.converged ? null : (before?.deviation_since_at ?? at);
    next[name] = { name, ...before, deviation_since_at: since, ...part };
  }
  return next;
}

/** A pending error is kept with the time it began, so that it can be counted on between frames. */
function foldSignals(signals, changed, at) {
  const next = { ...signals };
  for (const [name, signal] of Object.entries(changed)) {
    const pending = signal.pending && {
      ...signal.pending,
      since: pendingSince(signal.pending, signals[name]?.pending, at),
    };
    next[name] = { ...signal, pending };
  }
  return next;
}

function pendingSince(pending, before, at) {
  if (pending.since_at) return Date.parse(pending.since_at);
  const since = Date.parse(at) - 1000 * (pending.for_s ?? 0);
  return before?.error === pending.error ? Math.min(before.since, since) : since;
}
