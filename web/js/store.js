/** The known state of the robot, as a pure fold of the frames of the stream.
 *
 * `fold(state, message)` returns the next state and does not change the given one. Besides the
 * frames of the server it takes messages of the page: `log` (`items` of /events), `path` (waypoints
 * of a task), `latch` (the answer to a press of STOP) and `restart_read` (the notice was dismissed).
 */

const EVENTS_KEPT = 200;

/** The state before the first frame: nothing is known. */
export function emptyState() {
  return {
    epoch: null,
    restartedAt: null,
    at: null,
    systemState: null,
    parts: {},
    signals: {},
    task: null,
    path: null,
    vehicle: null,
    holds: {},
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

/** The task that has not ended, or null; `state.task` may also be the last one that ended. */
export function currentTask({ task }) {
  return task && !task.ended_at ? task : null;
}

const FOLDERS = {
  /** After a restart of the service the earlier state is void. */
  hello(state, { epoch, started_at }) {
    if (epoch === state.epoch) return state;
    if (state.epoch === null) return { ...state, epoch };
    const note = {
      note: "The service was restarted: nothing moves before somebody asks.",
      id: `restart-${epoch}`,
    };
    const events = keep([...state.events, note]);
    return { ...emptyState(), epoch, restartedAt: started_at, events };
  },

  restart_read(state) {
    return { ...state, restartedAt: null };
  },

  /** Frames carry changes; the first one, and the first after a loss, carry everything. */
  state(state, frame) {
    return {
      ...state,
      at: frame.at,
      systemState: frame.system_state ?? state.systemState,
      parts: frame.parts ? { ...state.parts, ...frame.parts } : state.parts,
      signals: frame.signals ? { ...state.signals, ...frame.signals } : state.signals,
      task: frame.task === undefined ? state.task : frame.task,
      vehicle: frame.vehicle ?? state.vehicle,
      holds: frame.holds ?? state.holds,
      emergencyStop: newerStop(state.emergencyStop, frame),
    };
  },

  event(state, event) {
    if (event.id <= state.lastEventId) return state;
    return { ...state, lastEventId: event.id, events: keep([...state.events, event]) };
  },

  /** The log is requested once; events of the stream may arrive before the answer. */
  log(state, { items }) {
    const begin = state.events.findLastIndex((event) => event.note) + 1;
    const streamed = state.events.slice(begin);
    const known = new Set(streamed.map((event) => event.id));
    const older = items.filter((event) => !known.has(event.id)).sort((a, b) => a.id - b.id);
    const lastEventId = Math.max(state.lastEventId, ...items.map((event) => event.id));
    const events = keep([...state.events.slice(0, begin), ...older, ...streamed]);
    return { ...state, lastEventId, events };
  },

  /** Without `to` the number is unknown: the server was restarted, and ids start again. */
  gap(state, { from, to }) {
    const which = to ? `Events ${from} to ${to}` : `Events after ${from - 1}`;
    const note = { note: `${which} are missing here.`, id: `gap-${from}` };
    const lastEventId = to ? Math.max(to, state.lastEventId) : state.lastEventId;
    return { ...state, lastEventId, events: keep([...state.events, note]) };
  },

  latch(state, { latch }) {
    return { ...state, emergencyStop: latch };
  },

  path(state, { task, items, indices }) {
    return { ...state, path: { task, items, indices } };
  },
};

/** A frame that was sent before the answer to STOP holds the earlier state. */
function newerStop(known, { at, emergency_stop }) {
  const isOld = known?.since_at && Date.parse(at) < Date.parse(known.since_at);
  return !emergency_stop || isOld ? known : emergency_stop;
}

function keep(events) {
  return events.slice(-EVENTS_KEPT);
}
