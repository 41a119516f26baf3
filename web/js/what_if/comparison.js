/** A simulated moment beside the live one: pure functions. */

import { errorName, isOn } from "/web/js/base/error_groups.js";
import { robotSentence } from "/web/js/base/state_sentence.js";
import { emptyState } from "/web/js/base/store.js";
import { percent, speedWords, TASK_STATUS, waypointWords } from "/web/js/base/task_words.js";
import { label } from "/web/js/base/words.js";

const MOST_PARTS = 12;
const MOST_NAMES = 4;

/** A sample of a simulation in the form of the state of the page. */
export function stateOf(sample) {
  const { system_state, emergency_stop, ...members } = sample;
  const { parts, signals, errors, reactions, task, vehicle, holds } = members;
  const known = { parts, signals, errors, reactions, task, vehicle, holds };
  const at = system_state.at;
  return { ...emptyState(), ...known, at, systemState: system_state, emergencyStop: emergency_stop };
}

/** Return rows `{topic, live, simulated, differs}`; parts only where they differ. */
export function compare(live, simulated) {
  const rows = TOPICS.map(([topic, words]) => [topic, words(live), words(simulated)]);
  return [...rows, ...partRows(live, simulated)].map(([topic, now, then]) => ({
    topic,
    live: now,
    simulated: then,
    differs: now !== then,
  }));
}

const TOPICS = [
  ["State", stateWords],
  ["Errors", (state) => names(Object.values(state.errors).filter(isOn).map(errorName))],
  ["Task", taskWords],
  ["Speed", ({ vehicle }) => speedWords(vehicle?.speed_mps)],
  ["Holds", ({ holds }) => names(Object.keys(holds))],
  ["Emergency stop", ({ emergencyStop }) => (emergencyStop?.engaged ? "engaged" : "not engaged")],
];

function stateWords(state) {
  const said = robotSentence(state);
  return said ? `${said.word}: ${said.text}` : "?";
}

function taskWords({ task }) {
  if (!task) return "none";
  if (task.ended_at) return `${task.id} ${TASK_STATUS[task.status].toLowerCase()}`;
  return `${TASK_STATUS[task.status]}, ${percent(task.progress)}, ${waypointWords(task)}`;
}

function names(all) {
  if (all.length === 0) return "none";
  const more = all.length > MOST_NAMES ? ` and ${all.length - MOST_NAMES} more` : "";
  return all.toSorted().slice(0, MOST_NAMES).join(", ") + more;
}

function partRows(live, simulated) {
  const rows = [];
  for (const [name, part] of Object.entries(simulated.parts)) {
    const [now, then] = [live.parts[name], part].map(partWords);
    if (now !== then) rows.push([name, now, then]);
  }
  const more = rows.length - MOST_PARTS;
  if (more <= 0) return rows;
  return [...rows.slice(0, MOST_PARTS), [`${more} more parts`, "", "differ as well"]];
}

function partWords(part) {
  if (!part) return "?";
  const shown = part.actual.state === "unknown" ? "unknown" : label(part.actual);
  return part.reachable === false && shown !== "unknown" ? `${shown}, unreachable` : shown;
}
