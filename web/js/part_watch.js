/** Follows what the stream does not carry of the selected part.
 *
 * That is what may be asked of it, why something may not, and how its last change goes.
 */

import { partPath, request } from "/web/js/api.js";

const PAUSE_MS = 200;
const FOLLOW_MS = 400;

/** Calls `changed` after each load; `transitions`, `modes` and `change` are the newest answers. */
export class PartWatch {
  part = null;
  transitions = [];
  modes = [];
  change = null;
  #changed;
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
    this.#changed();
    const [{ items }] = await this.#answers(["/changes"]);
    const last = items?.filter((change) => change.part === part.name).at(-1);
    if (this.part === part && last && this.change === null) this.change = last;
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
      if (this.#again) this.refresh();
    }, PAUSE_MS);
  }

  /** Follow a change that was just asked for. */
  follow(change) {
    this.change = change;
    this.#changed();
    this.refresh();
  }

  async #load(part) {
    const path = partPath(part);
    const paths = [`${path}/state`, `${path}/modes`, path];
    if (this.change?.status === "running") paths.push(`/changes/${this.change.id}`);
    const [state, modes, whole, change] = await this.#answers(paths);
    if (this.part !== part) return;
    this.transitions = state.available_transitions ?? this.transitions;
    this.modes = modes.items ?? this.modes;
    if (change?.id && change.id === this.change?.id) this.change = change;
    const running = whole.change;
    if (running && running !== this.change?.id) {
      const [newer] = await this.#answers([`/changes/${running}`]);
      if (newer.id && this.part === part) this.change = newer;
    }
    this.#changed();
    if (this.change?.status === "running") setTimeout(() => this.refresh(), FOLLOW_MS);
  }

  /** What cannot be loaded stays as it was: the state bar tells of lost contact. */
  #answers(paths) {
    return Promise.all(paths.map((path) => request("GET", path).catch(() => ({}))));
  }
}
