/** Loads the path of the shown task, which is too large for a frame and never changes. */

import { request } from "/web/js/base/api.js";

const MOST_POINTS = 2000;
const RETRY_MS = 1000;

/** Calls `tell` with a `path` message for the store. */
export class PathWatch {
  #tell;
  #busy = false;

  constructor(tell) {
    this.#tell = tell;
  }

  /** Request the path if the task is another one; after a failure it is requested again. */
  async look({ task, path }) {
    if (!task || path?.task === task.id || this.#busy) return;
    this.#busy = true;
    const waypoints = `/tasks/${task.id}/waypoints?max_points=${MOST_POINTS}`;
    // The state bar shows lost contact; there is nothing to add here.
    const answer = await request("GET", waypoints).catch(() => null);
    if (answer) this.#tell({ type: "path", task: task.id, ...answer });
    // A pause, so that a rejected request is not repeated with each frame.
    setTimeout(() => (this.#busy = false), answer ? 0 : RETRY_MS);
  }
}
