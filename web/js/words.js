/** What the page says, in words: pure functions from facts to text. */

/** "0.4 s", "12 s", "3 min 5 s", "2 h 4 min". */
export function duration(ms) {
  const s = Math.max(0, ms) / 1000;
  if (s < 10) return `${s.toFixed(1)} s`;
  if (s < 60) return `${Math.floor(s)} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${Math.floor(s % 60)} s`;
  return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
}

/** Whole seconds, for what ticks in a sentence. */
export function wholeSeconds(ms) {
  return ms < 60_000 ? `${Math.floor(ms / 1000)} s` : duration(ms);
}

/** Local time of day, 24 hours. */
export function timeOfDay(at) {
  return new Date(at).toLocaleTimeString("en-GB");
}

/** "active.FAST", as in ROS 2; "?" where it is not known. */
export function label({ state, mode }) {
  if (state === "unknown") return "?";
  return mode ? `${state}.${mode}` : state;
}

/** The sentence at the top: `{level, word, text, more}`, most important reason first. */
export function stateSentence(state, contact) {
  const { systemState } = state;
  if (contact.level === "lost") {
    const since = state.at
      ? `values shown are from ${timeOfDay(state.at)}`
      : "nothing is known yet";
    return sentence("lost", `No contact for ${wholeSeconds(contact.silenceMs)}`, since);
  }
  if (systemState === null) return sentence("late", "Connecting", "waiting for the first values");
  if (systemState.state !== "ERROR") {
    return sentence(
      systemState.state.toLowerCase(),
      systemState.state,
      TASKS[systemState.task_status],
    );
  }
  const reasons = systemState.reasons.map((reason) => reason.message);
  const [first = systemState.errors.join(", "), ...more] = reasons;
  return sentence("error", "ERROR", first, more);
}

function sentence(level, word, text, more = []) {
  return { level, word, text, more };
}

const TASKS = {
  NO_TASK: "no task",
  PAUSED_TASK: "the task is paused",
  RUNNING_TASK: "the task is running",
};

/** What was asked for by a change. */
export function requestWords(asked) {
  if (typeof asked === "string") return asked;
  if (asked.mode) return `mode ${asked.mode}`;
  if (asked.transition) return asked.transition;
  return "parameters";
}

/** The state of a change in words, with the time it took or has taken. */
export function changeWords(change, now) {
  const took = duration(
    (change.ended_at ? Date.parse(change.ended_at) : now) - Date.parse(change.started_at),
  );
  const words = CHANGE_STATUS[change.status] ?? change.status;
  return `${words} ${change.status === "running" ? "for" : "after"} ${took}`;
}

const CHANGE_STATUS = {
  running: "running",
  succeeded: "succeeded",
  failed: "failed",
  timed_out: "timed out",
  superseded: "superseded by a newer request",
  canceled: "canceled",
};

const EVENT_WORDS = {
  "signal.pending": ({ signal, error }) => `${signal} is bad; ${error} follows if it lasts`,
  "signal.settled": ({ signal, error }) => `${signal} is good again; no ${error}`,
  "error.raised": ({ error, message }) => `${error}: ${message}`,
  "error.cleared": ({ error }) => `${error} is over`,
  "system_state.changed": ({ was, state, errors }) =>
    [was === state ? state : `${was} to ${state}`, errors.join(", ")].filter(Boolean).join(": "),
  "part.actual_changed": ({ part, was, actual }) => `${part}: ${was} to ${actual}`,
  "part.deviation_began": ({ part, actual, target }) => `${part} is ${actual}, not ${target}`,
  "part.deviation_ended": ({ part, actual }) => `${part} is ${actual}, as asked`,
  "change.requested": ({ part, ...asked }) => `${part}: ${requestWords(asked)}`,
  "change.step_started": ({ node, action }) => `${node}: ${action}`,
  "change.step_ended": ({ node, action, status, error }) =>
    `${node}: ${action} ${status}${error ? `, ${error}` : ""}`,
};

/** What happened, in words; an event of a kind not known here tells its data as they are. */
export function eventWords({ kind, data }) {
  if (EVENT_WORDS[kind]) return EVENT_WORDS[kind](data);
  return Object.entries(data)
    .filter(([, value]) => value !== null && value !== "" && !isEmpty(value))
    .map(([name, value]) => `${name.replaceAll("_", " ")} ${plain(value)}`)
    .join(", ");
}

function isEmpty(value) {
  return typeof value === "object" && Object.keys(value).length === 0;
}

function plain(value) {
  if (typeof value !== "object") return String(value);
  if (Array.isArray(value)) return value.map(plain).join(" ");
  if ("state" in value) return label(value);
  return Object.entries(value)
    .map(([name, inner]) => `${name} ${plain(inner)}`)
    .join(" ");
}
