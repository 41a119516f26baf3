/** The sentences that tell the state of the robot: pure functions.
 *
 * `api/cli/monitor/sentence.py` has the same rules; one test runs both over the same cases.
 */

import { errorName, isPressing } from "/web/js/base/error_groups.js";
import { partProblems } from "/web/js/base/part_problems.js";
import { currentTask } from "/web/js/base/store.js";
import { percent, speed, TASK_STATUS, waypointWords } from "/web/js/base/task_words.js";
import { timeOfDay, wholeSeconds } from "/web/js/base/words.js";

/** Below this a vehicle stands, m/s; the service uses the same limit. */
const STANDSTILL_MPS = 0.05;
const NAMED = 3;
/** Words for a vehicle that should stand and does not, or of which it is not known. */
const ALARMS = { STILL_MOVING: "STILL MOVING", STANDSTILL_UNKNOWN: "STANDSTILL UNKNOWN" };
/** Words with a level of their own: nothing is wrong, and yet a person has to do something. */
const LEVELS = { HELD: "held", ABORTED: "aborted" };
const NO_CONTACT = ["lost", "lost"];

/** The sentence at the top of the page: `{level, sign, word, text, more}`.
 *
 * `level` is calm, held, aborted, attention, error, late or lost; `sign` names the icon; `more` has
 * further lines.
 */
export function stateSentence(state, contact) {
  if (contact.level === "lost") {
    const text = state.at
      ? `values shown are from ${timeOfDay(state.at)}`
      : "no values received yet";
    const [word, last] = [`No contact for ${wholeSeconds(contact.silenceMs)}`, robotSentence(state)];
    const was = last ? [`it was ${last.word}: ${last.text}`, ...last.more] : [];
    return sentence(NO_CONTACT, word, text, was);
  }
  const waiting = sentence(["late", "late"], "Connecting", "waiting for the first values");
  return robotSentence(state) ?? waiting;
}

/** The sentence on the robot as it was in the last frame; null before the first. */
export function robotSentence(state) {
  if (state.systemState === null) return null;
  const { state: name, errors, reasons } = state.systemState;
  const task = currentTask(state);
  const reasonTexts = reasons.map(({ message }) => message);
  const alarm = ALARMS[reasons[0]?.code];
  // An alarm tells already how fast the vehicle moves.
  const found = [...(alarm ? [] : movement(state, name)), ...partProblems(state.parts, state.devices)];
  if (name === "ERROR") {
    const [first = errors.join(", "), ...others] = reasonTexts;
    const text = task ? `${first}, task ${task.id} is ${STANDS[task.status]}` : first;
    const more = [...others, ...found, ...otherHolds(state), ...aborted(state)];
    return sentence(["error", "error"], alarm ?? "ERROR", text, more);
  }
  const { word, text } = activity(state, task);
  const [first, ...more] = [...reasonTexts, ...(found.length ? found : pressing(state))];
  const { vehicle, drive_process: undriven, navigation } = state.holds;
  const isWrong = first || vehicle || undriven || navigation;
  const level = alarm ? "error" : isWrong ? "attention" : (LEVELS[word] ?? "calm");
  const sign = alarm ? "error" : word.toLowerCase();
  return sentence([level, sign], alarm ?? word, first ? `${first}; ${text}` : text, more);
}

/** The urgent errors of a robot that looks well otherwise; those of parts are told with these. */
function pressing({ errors }) {
  const all = Object.values(errors).filter(isPressing).map(errorWords);
  const left = all.length - NAMED;
  return left > 0 ? [...all.slice(0, NAMED), `${left} more such ${left === 1 ? "error" : "errors"}`] : all;
}

/** What the sentence says of an urgent error. */
export function errorWords(error) {
  return error.message ? `${errorName(error)}: ${error.message}` : errorName(error);
}

/** Whether the vehicle stands under the emergency stop. */
export function standstillWords(state) {
  if (state.ownDevice) return "the vehicle is the supervisor's to stop";
  const moves = movingAt(state);
  if (ALARMS[state.systemState?.reasons[0]?.code])
    return moves === null
      ? "use the hardware stop: the vehicle may be moving"
      : `use the hardware stop: the vehicle still moves at ${speed(moves)}`;
  if (moves !== null) return `the vehicle moves at ${speed(moves)}`;
  const isKnown = typeof state.vehicle?.speed_mps === "number" && !state.holds.vehicle;
  if (!isKnown) return "it is not known whether the vehicle stands";
  return state.emergencyStop?.standstill_at
    ? "the vehicle is at a standstill"
    : "no standstill yet";
}

/** Whether the vehicle moves, or should stand and may not. */
export function mayMove(state) {
  return movingAt(state) !== null || Boolean(ALARMS[state.systemState?.reasons[0]?.code]);
}

/** That what happens is not stored: `{word, text}`; null while it is. */
export function storageSentence({ systemState }, contact) {
  const fault = systemState?.storage_fault;
  if (!fault) return null;
  if (contact.level === "lost") return { word: "STORAGE FAILED", text: fault };
  return { word: "STORAGE FAILS", text: `${fault}; a restart may forget what you ask now` };
}

function sentence([level, sign], word, text, more = []) {
  return { level, sign, word, text, more };
}

/** What the robot does apart from what is wrong; a task with a hold is never called running. */
function activity(state, task) {
  const { task_status } = state.systemState;
  const held = heldBy(Object.values(state.holds));
  if (task === null) {
    if (task_status === "RUNNING_TASK") return { word: "RUNNING", text: "the task is running" };
    if (task_status === "PAUSED_TASK") return { word: "PAUSED", text: "the task is paused" };
    const [text] = aborted(state);
    const next = held && `; a new one would be ${held}`;
    return text ? { word: "ABORTED", text: `${text}${next}` } : { word: "IDLE", text: `no task${next}` };
  }
  const at = `task ${task.id} at ${percent(task.progress)}`;
  const why = held || task.reason;
  const text = why ? `${at}, ${why}` : at;
  const moves = movingAt(state);
  if (task.status === "PAUSING")
    return { word: "STOPPING", text: moves === null ? text : `${text}, still at ${speed(moves)}` };
  if (held) return { word: "HELD", text };
  if (task.status === "PAUSED") return { word: "PAUSED", text };
  return {
    word: "RUNNING",
    text: `task ${task.id} ${percent(task.progress)}, ${waypointWords(task)}`,
  };
}

/** "held by gate (the gate is shut), operator and loading"; empty without holds. */
function heldBy(holds) {
  const named = holds.slice(0, NAMED).map(holdWords);
  if (holds.length > NAMED) named.push(`${holds.length - NAMED} more`);
  const last = named.pop();
  if (last === undefined) return "";
  return `held by ${named.length ? `${named.join(", ")} and ${last}` : last}`;
}

/** The name of the hold of a restart says why; its reason says how it ends, in the list of holds. */
function holdWords({ owner, reason }) {
  return reason && owner !== "restart" ? `${owner} (${reason})` : owner;
}

/** In ERROR: the holds that stay when the error is gone. */
function otherHolds({ holds }) {
  const held = heldBy(Object.values(holds).filter(({ owner }) => owner !== "error"));
  return held ? [`also ${held}`] : [];
}

function aborted({ task }) {
  if (!task?.ended_at || task.status !== "ABORTED") return [];
  const why = task.reason ? `: ${task.reason}` : "";
  return [`task ${task.id} was ${TASK_STATUS.ABORTED.toLowerCase()} at ${timeOfDay(task.ended_at)}${why}`];
}

/** A vehicle that moves though no task drives or stops it. */
function movement(state, name) {
  const moves = movingAt(state);
  const status = currentTask(state)?.status;
  const isHeld = Object.keys(state.holds).length > 0;
  const drives = status === "PAUSING" || (status === "RUNNING" && !isHeld);
  if (moves === null || (drives && name !== "ERROR")) return [];
  return [`the vehicle moves at ${speed(moves)}`];
}

/** Speed of a vehicle that is known to move, m/s; null: it stands, or it is not known. */
function movingAt({ vehicle, holds }) {
  const moves = vehicle?.speed_mps;
  // The hold is set while there is no pose that is recent enough.
  if (typeof moves !== "number" || holds.vehicle || Math.abs(moves) < STANDSTILL_MPS) return null;
  return Math.abs(moves);
}

const STANDS = { RUNNING: "running", PAUSING: "stopping", PAUSED: "paused" };
