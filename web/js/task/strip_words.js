/** Texts of the task strip: pure functions. */

import {
  controllerName,
  metres,
  offPath,
  percent,
  speedWords,
  TASK_STATUS,
  waypointWords,
} from "/web/js/base/task_words.js";
import { duration, timeOfDay } from "/web/js/base/words.js";

/** Word and symbol of each status; a paused task is held by something. */
const LOOKS = {
  RUNNING: ["RUNNING", "running"],
  PAUSING: ["STOPPING", "stopping"],
  PAUSED: ["HELD", "held"],
  SUCCEEDED: ["SUCCEEDED", "done"],
  CANCELED: ["CANCELED", "canceled"],
  ABORTED: ["ABORTED", "aborted"],
};

/** What the strip says: `{word, symbol, name, controller, way, more, readings}`, the last as pairs. */
export function stripWords(state, { at }) {
  const { task, vehicle } = state;
  const speed = ["Speed", speedWords(vehicle?.speed_mps)];
  if (state.systemState === null) return said("UNKNOWN", "late", "Nothing was received yet.", []);
  if (!task) return said("NO TASK", "idle", "The vehicle has no path to drive.", [speed]);
  const [word, symbol] = LOOKS[task.status];
  const controller = controllerName(task.controller);
  if (task.ended_at)
    return { word, symbol, name: `task ${task.id}`, controller, way: endLine(task), more: pastLine(task), readings: [speed] };
  const error = ["Off path", offPath(task.cross_track_error_m)];
  const way = capital(waypointWords(task));
  // Held, it stands: there is more to say of what holds it.
  const readings = task.status === "PAUSED" ? [speed] : [etaReading(task, at), error, speed];
  const name = `task ${task.id}, ${percent(task.progress)}`;
  return { word, symbol, name, controller, way, more: "", readings };
}

/** "By gate: the gate is shut, +2 more", after the word HELD; empty where nothing holds. */
export function heldWords(holds) {
  const [first] = holds;
  if (!first) return "";
  const more = holds.length > 1 ? `, +${holds.length - 1} more` : "";
  return `By ${holdWords(first)}${more}`;
}

export function holdWords({ owner, reason }) {
  return reason ? `${owner}: ${reason}` : owner;
}

/** What is told when the status changes. */
export function spokenWords({ id, status, reason }) {
  return `Task ${id} ${TASK_STATUS[status].toLowerCase()}${reason ? `: ${reason}` : ""}`;
}

function said(word, symbol, way, readings) {
  return { word, symbol, name: "", controller: null, way, more: "", readings };
}

/** The time at which the task ends if nothing holds it, and how long that is. */
function etaReading({ status, length_m, distance_m, speed_mps }, now) {
  if (status !== "RUNNING") return ["ETA", "–"];
  const leftMs = (1000 * Math.max(0, length_m - distance_m)) / speed_mps;
  return [`ETA ${timeOfDay(now + leftMs).slice(0, 5)}`, roughly(leftMs)];
}

/** "4 min", "50 s": no digits that change with each report. */
function roughly(ms) {
  return ms >= 120_000 ? `${Math.round(ms / 60_000)} min` : `${Math.ceil(ms / 10_000) * 10} s`;
}

function endLine({ status, reason, ended_at }) {
  const why = reason && reason !== TASK_STATUS[status].toLowerCase() ? `: ${reason}` : "";
  return `At ${timeOfDay(ended_at)}${why}`;
}

function pastLine({ created_at, ended_at, distance_m, length_m }) {
  const took = duration(Date.parse(ended_at) - Date.parse(created_at));
  return `${metres(distance_m)} of ${metres(length_m)} in ${took}`;
}

function capital(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
