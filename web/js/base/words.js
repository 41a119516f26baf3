/** Texts of the page: pure functions. */

/** "0.4 s", "12 s", "3 min 5 s", "2 h 4 min". */
export function duration(ms) {
  const s = Math.max(0, ms) / 1000;
  if (s < 10) return `${s.toFixed(1)} s`;
  if (s < 60) return `${Math.floor(s)} s`;
  if (s < 3600) return `${Math.floor(s / 60)} min ${Math.floor(s % 60)} s`;
  return `${Math.floor(s / 3600)} h ${Math.floor((s % 3600) / 60)} min`;
}

/** Whole seconds, for durations that count up in a sentence. */
export function wholeSeconds(ms) {
  return ms < 60_000 ? `${Math.floor(ms / 1000)} s` : duration(ms);
}

/** Local time of day, 24 hours. */
export function timeOfDay(at) {
  return new Date(at).toLocaleTimeString("en-GB");
}

/** The time of day, with the date if that is not today's. */
export function timeAndDay(at, now = Date.now()) {
  const date = isoDate(at);
  return date === isoDate(now) ? timeOfDay(at) : `${timeOfDay(at)} on ${date}`;
}

/** The mode that every part has is called "__DEFAULT__" in models, and "default" here. */
export function modeName(mode) {
  return mode === "__DEFAULT__" ? "default" : mode;
}

/** "active.FAST", as in ROS 2; "?" where it is not known. */
export function label({ state, mode }) {
  if (state === "unknown") return "?";
  return mode ? `${state}.${modeName(mode)}` : state;
}

/** What a change requests. */
export function requestWords(asked) {
  if (typeof asked === "string") return asked;
  if (asked.mode) return `mode ${modeName(asked.mode)}`;
  if (asked.transition) return asked.transition;
  return "parameters";
}

/** Whether a change has not ended: it runs, or waits until it may. */
export function isOpen({ status }) {
  return status === "running" || status === "waiting";
}

/** The status of a change, with its duration so far. */
export function changeWords(change, now) {
  const took = duration(
    (change.ended_at ? Date.parse(change.ended_at) : now) - Date.parse(change.started_at),
  );
  const isBack = change.status === "running" && change.steps.some(({ rollback }) => rollback);
  const words = isBack ? "going back" : (CHANGE_STATUS[change.status] ?? change.status);
  return `${words} ${isOpen(change) ? "for" : "after"} ${took}`;
}

/** Local date, "2026-03-01". */
export function isoDate(at) {
  return new Date(at).toLocaleDateString("sv-SE");
}

const CHANGE_STATUS = {
  waiting: "waiting",
  running: "running",
  succeeded: "succeeded",
  failed: "failed",
  timed_out: "timed out",
  superseded: "superseded by a newer request",
  canceled: "canceled",
};
