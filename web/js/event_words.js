/** What happened, in words: pure functions from events to text. */

import { metres, percent } from "/web/js/task_words.js";
import { label, requestWords } from "/web/js/words.js";

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
  "node.restoring": ({ node, target }) => `${node} is back, and restored to ${target}`,
  "node.not_restored": ({ node, reason }) => because(`${node} is back, not restored`, reason),
  "task.requested": ({ waypoints, length_m, controller, speed_mps }) =>
    `${waypoints} waypoints, ${metres(length_m)} by ${controller} at ${speed_mps} m/s`,
  "task.served": ({ task, length_m }) => `${task}, ${metres(length_m)}`,
  "task.started": ({ task }) => `${task} drives`,
  "task.resumed": ({ task }) => `${task} drives on`,
  "task.pausing": ({ task, reason }) => because(`${task} stops`, reason),
  "task.paused": ({ task, reason }) => because(`${task} stands`, reason),
  "task.succeeded": ({ task }) => `${task} is at its end`,
  "task.canceled": ({ task, progress, reason }) =>
    because(`${task} at ${percent(progress)}`, reason),
  "task.aborted": ({ task, progress, reason }) =>
    because(`${task} at ${percent(progress)}`, reason),
  "hold.set": ({ owner, reason }) => because(owner, reason),
  "hold.released": ({ owner }) => owner,
  "audit.write": ({ method, path, status, address }) =>
    `${method} ${path} from ${address}, answered ${status}`,
};

/** What happened, in words; an event of a kind not known here tells its data as they are. */
export function eventWords({ kind, data }) {
  if (EVENT_WORDS[kind]) return EVENT_WORDS[kind](data);
  return Object.entries(data)
    .filter(([, value]) => value !== null && value !== "" && !isEmpty(value))
    .map(([name, value]) => `${name.replaceAll("_", " ")} ${plain(value)}`)
    .join(", ");
}

function because(what, reason) {
  return reason ? `${what}: ${reason}` : what;
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
