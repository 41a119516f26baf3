/** What is said after a restart of the service: pure functions of the state. */

import { currentTask } from "/web/js/base/store.js";
import { timeOfDay } from "/web/js/base/words.js";

/** Holds that Pilothouse sets and clears by itself. */
const OWN = new Set(["restart", "error", "vehicle", "drive_process", "navigation"]);

/** "Started again at 14:02:03; it remembers task t1 and the hold of gate"; null while unknown. */
export function rememberedWords({ restartedAt, boot, systemState, holds, parts, ...state }) {
  if (restartedAt === null || systemState === null) return null;
  const when = `Started again at ${timeOfDay(restartedAt)}`;
  if (boot <= 1) return `${when}; it remembers nothing: earlier tasks and holds are gone`;
  const task = currentTask(state);
  const isOlder = ({ since_at }) => Date.parse(since_at) < Date.parse(restartedAt);
  const owners = Object.values(holds).filter((hold) => !OWN.has(hold.owner) && isOlder(hold));
  const wanted = Object.values(parts).filter(({ target }) => target).length;
  const kept = [
    task && `task ${task.id}`,
    owners.length && `the hold${owners.length > 1 ? "s" : ""} of ${joined(owners.map(({ owner }) => owner))}`,
    wanted && (wanted === 1 ? "the target of 1 part" : `the targets of ${wanted} parts`),
    state.emergencyStop?.engaged && "the emergency stop",
  ].filter(Boolean);
  return `${when}; it remembers ${joined(kept) || "its log, and there was nothing else to keep"}`;
}

/** What waits for somebody after a restart; empty: nothing does. */
export function waitingWords({ holds, ...state }) {
  if (!holds.restart) return "";
  const task = currentTask(state);
  return task ? "the task is held by restart" : "driving is held by restart";
}

function joined(words) {
  const last = words.at(-1) ?? "";
  return words.length > 1 ? `${words.slice(0, -1).join(", ")} and ${last}` : last;
}
