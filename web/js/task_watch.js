/** Follows what the stream does not carry of the task: its path, the holds, how it ended. */

import { request } from "/web/js/api.js";

const MOST_POINTS = 2000;
const RETRY_MS = 1000;
const ENDS = new Set(["task.succeeded", "task.canceled", "task.aborted"]);

/** Calls `tell` with messages for the store. */
export class TaskWatch {
  #tell;
  #busy = false;
  #holdsAsked = 0;

  constructor(tell) {
    this.#tell = tell;
  }

  /** Take an event of the stream. */
  hear(frame) {
    if (frame.type !== "event") return;
    if (/^(hold|task)\./.test(frame.kind)) this.loadHolds();
    if (ENDS.has(frame.kind)) this.loadLast();
  }

  /** Look at what is known now, and ask for what is missing. */
  look({ task, path }) {
    if (task && path?.task !== task.id) this.#loadPath(task.id);
  }

  /** Of several answers the one that was asked for last counts. */
  async loadHolds() {
    const asked = ++this.#holdsAsked;
    const answer = await this.#answer("/holds");
    if (answer && asked === this.#holdsAsked) this.#tell({ type: "holds", items: answer.items });
  }

  /** Learn how the task that ended last did so. */
  async loadLast() {
    const answer = await this.#answer("/tasks");
    const last = answer?.items.find((task) => task.ended_at);
    if (last) this.#tell({ type: "ended_task", task: last });
  }

  /** One request at a time; what was not answered is asked for again with a later look. */
  async #loadPath(task) {
    if (this.#busy) return;
    this.#busy = true;
    const answer = await this.#answer(`/tasks/${task}/waypoints?max_points=${MOST_POINTS}`);
    if (answer) this.#tell({ type: "path", task, ...answer });
    // A pause, so that a refusal is not asked for with each frame.
    setTimeout(() => (this.#busy = false), answer ? 0 : RETRY_MS);
  }

  /** What cannot be loaded stays as it was: the state bar tells of lost contact. */
  #answer(path) {
    return request("GET", path).catch(() => null);
  }
}
