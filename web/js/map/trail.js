/** Where the vehicle was in the last minutes, and the state that the system was in there. */

import { include } from "/web/js/map/bounds.js";

const KEPT_MS = 5 * 60_000;
const LEAST_STEP_M = 0.05;
const PLACES_OF_A_RUN = 200;
// Between two reports so far apart the path is unknown, so no line is drawn.
const GAP_MS = 2000;
const JUMP_M = 3;

/** `runs` are lines of one state each; a Path2D of a run is counted from `origin`. */
export class Trail {
  runs = [];
  version = 0;
  #last = null;
  #lastAt = -Infinity;

  /** Take one report; `at` in ms since 1970. */
  add(pose, at, state) {
    if (pose === null || at <= this.#lastAt) return;
    const apart = this.#last ? Math.hypot(pose.x_m - this.#last.x_m, pose.y_m - this.#last.y_m) : 0;
    const broken = this.#last === null || at - this.#lastAt > GAP_MS || apart > JUMP_M;
    this.#lastAt = at;
    this.#forget(at);
    if (!broken && apart < LEAST_STEP_M) return;
    const run = this.runs.at(-1);
    if (broken || !run) this.#begin(pose, state);
    else if (run.state !== state || run.count >= PLACES_OF_A_RUN) this.#begin(this.#last, state);
    this.#extend(pose, at);
  }

  /** Forget all, as after a restart of the server. */
  clear() {
    this.runs = [];
    this.version += 1;
    this.#last = null;
  }

  #begin(place, state) {
    const shape = new Path2D();
    shape.moveTo(0, 0);
    const origin = { x_m: place.x_m, y_m: place.y_m };
    this.runs.push({ state, origin, shape, bounds: include(null, place), count: 0, endAt: 0 });
  }

  #extend(pose, at) {
    const run = this.runs.at(-1);
    run.shape.lineTo(pose.x_m - run.origin.x_m, pose.y_m - run.origin.y_m);
    run.bounds = include(run.bounds, pose);
    run.count += 1;
    run.endAt = at;
    this.#last = pose;
    this.version += 1;
  }

  #forget(now) {
    while (this.runs.length > 0 && now - this.runs[0].endAt > KEPT_MS) {
      this.runs.shift();
      this.version += 1;
    }
  }
}
