/** Follows what the stream does not carry of the selected part.
 *
 * That is what may be asked of it, why something may not, and how its last change goes.
 */

import { partPath, request } from "/web/js/api.js";

// One load is three requests, so that a burst of events must not lead to a burst of loads.
const PAUSE_MS = 500;

/** Calls `changed` after each load; `transitions`, `modes` and `change` are the newest answers. */
export class PartWatch {
  part = null;
  transitions = [];
  modes = [];
  change = null;
  #changed;
  #changeId = null;
  #epoch = null;
  #busy = false;
  #again = false;

  constructor(changed) {
    this.#changed = changed;
  }

  /** Follow another part. */
  async select(part) {
    this.part = part;
    this.transitions = this.modes = [];
    this.change = null;
    this.#changeId = part.change;
    this.#changed();
    this.refresh();
    const [{ items }] = await this.#answers(["/changes"]);
    const last = items?.find((change) => change.part === part.name);
    if (this.part === part && last && this.#changeId === null) this.follow(last);
  }

  /** Learn from a frame which change the part is under, or which one has just ended.
   *
   * A quick change can begin and end between two frames: only its last event names it.
   */
  hear(frame) {
    if (frame.type === "hello") this.#begin(frame.epoch);
    if (this.part === null) return;
    if (frame.type === "state") this.#name(frame.parts?.[this.part.name]?.change);
    if (frame.type !== "event") return;
    const { part, change } = frame.data;
    // What supersedes a change is newer than it, and known by its own frames.
    if (part === this.part.name && frame.kind !== "change.superseded") this.#name(change);
    this.refresh();
  }

  /** Load now, or once more after the load under way: bursts become two loads, not many. */
  async refresh() {
    if (this.part === null) return;
    if (this.#busy) {
      this.#again = true;
      return;
    }
    this.#busy = true;
    this.#again = false;
    await this.#load(this.part);
    setTimeout(() => {
      this.#busy = false;
      if (this.#again || this.change?.status === "running") this.refresh();
    }, PAUSE_MS);
  }

  /** Follow a change that was just asked for, or that was the last. */
  follow(change) {
    this.change = change;
    this.#changeId = change.id;
    this.#changed();
    this.refresh();
  }

  /** A server that was restarted counts its changes anew: an old id would name another change. */
  #begin(epoch) {
    if (epoch !== this.#epoch) this.change = this.#changeId = null;
    this.#epoch = epoch;
  }

  #name(change) {
    if (!change || change === this.#changeId) return;
    this.#changeId = change;
    this.refresh();
  }

  async #load(part) {
    const path = partPath(part);
    const paths = [`${path}/state`, `${path}/modes`];
    const isKnown = this.change?.id === this.#changeId && this.change?.status !== "running";
    if (this.#changeId && !isKnown) paths.push(`/changes/${this.#changeId}`);
    const [state, modes, change] = await this.#answers(paths);
    if (this.part !== part) return;
    this.transitions = state.available_transitions ?? this.transitions;
    this.modes = modes.items ?? this.modes;
    if (change?.id && change.id === this.#changeId) this.change = change;
    this.#changed();
  }

  /** What cannot be loaded stays as it was: the state bar tells of lost contact. */
  #answers(paths) {
    return Promise.all(paths.map((path) => request("GET", path).catch(() => ({}))));
  }
}
