/** Loads the path of the task that is shown: it is too large for a frame, and never changes. */

import { request } from "/web/js/api.js";

const MOST_POINTS = 2000;
const RETRY_MS = 1000;

/** Calls `tell` with a `path` message for the store. */
export class PathWatch {
  #tell;
  #busy = false;

  constructor(tell) {
    this.#tell = tell;
  }

  /** Ask for the path if it is of another task; what was not answered is asked for again. */
  async look({ task, path }) {
    if (!task || path?.task === task.id || this.#busy) return;
    this.#busy = true;
    const waypoints = `/tasks/${task.id}/waypoints?max_points=${MOST_POINTS}`;
    // Lost contact is told by the state bar; there is nothing to add here.
    const answer = await request("GET", waypoints).catch(() => null);
    if (answer) this.#tell({ type: "path", task: task.id, ...answer });
    // A pause, so that a refusal is not asked for with each frame.
    setTimeout(() => (this.#busy = false), answer ? 0 : RETRY_MS);
  }
}
