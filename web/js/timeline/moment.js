/** Asks for the state of the robot at a moment. */

import { request } from "/web/js/base/api.js";
import { hintWords } from "/web/js/base/problem.js";
import { emptyState, fold } from "/web/js/base/store.js";

/** A replay begins up to ten minutes before the moment, and may wait for another one. */
const TIMEOUT_MS = 60_000;

/** Return the state that panels show of the time `at` (ms).
 *
 * @throws {ProblemError} It is not recorded, no longer kept, or cannot be read.
 */
export async function stateAt(at, live) {
  const path = `/frames?at=${new Date(at).toISOString()}`;
  const frame = await request("GET", path, undefined, { timeoutMs: TIMEOUT_MS });
  const { epoch, boot, events, eventsKept, oldestEventId, lastEventId, path: known } = live;
  const log = { epoch, boot, events, eventsKept, oldestEventId, lastEventId };
  const state = fold({ ...emptyState(), ...log }, frame);
  if (!state.task) return state;
  if (known?.task === state.task.id) return { ...state, path: known };
  return { ...state, path: await pathOf(state.task.id) };
}

/** The path of a task that is no longer kept is not shown. */
async function pathOf(task) {
  const path = `/tasks/${encodeURIComponent(task)}/waypoints?max_points=2000`;
  const answer = await request("GET", path).catch(() => null);
  return answer && { task, items: answer.items, indices: answer.indices };
}

/** Why a moment is not shown, in a sentence. */
export function refusalWords(error) {
  const why = error.status === 0 ? "the server did not answer" : error.message;
  const hint = hintWords(error.problem ?? {});
  return `That moment is not shown: ${why}${hint ? ` (${hint})` : ""}. Panels show now.`;
}
