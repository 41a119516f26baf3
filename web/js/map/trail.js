/** Where the vehicle was in the last minutes, and what it did there. */

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
  /** Changes with each place. */
  version = 0;
  /** Changes when a run begins or is forgotten: all runs but the last one rest in between. */
  settled = 0;
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
    else if (run.state !== state || run.places.length > PLACES_OF_A_RUN) this.#begin(this.#last, state);
    this.#extend(pose, at);
  }

  /** Forget all, as after a restart of the server. */
  clear() {
    this.runs = [];
    this.version += 1;
    this.settled += 1;
    this.#last = null;
  }

  /** The runs up to a moment, ms since 1970. */
  until(at) {
    const begun = this.runs.filter(({ places }) => places[0].at <= at);
    return begun.map((run) => {
      if (run.endAt <= at) return run;
      const places = run.places.filter((place) => place.at <= at);
      const cut = newRun(places[0], run.state, places[0].at);
      for (const place of places.slice(1)) extend(cut, place, place.at);
      return cut;
    });
  }

  #begin(place, state) {
    this.runs.push(newRun(place, state, this.#lastAt));
    this.settled += 1;
  }

  #extend(pose, at) {
    extend(this.runs.at(-1), pose, at);
    this.#last = pose;
    this.version += 1;
  }

  #forget(now) {
    while (this.runs.length > 0 && now - this.runs[0].endAt > KEPT_MS) {
      this.runs.shift();
      this.version += 1;
      this.settled += 1;
    }
  }
}

function newRun({ x_m, y_m }, state, at) {
  const shape = new Path2D();
  shape.moveTo(0, 0);
  const place = { x_m, y_m, at };
  return { state, origin: place, shape, bounds: include(null, place), places: [place], endAt: at };
}

function extend(run, { x_m, y_m }, at) {
  run.shape.lineTo(x_m - run.origin.x_m, y_m - run.origin.y_m);
  run.bounds = include(run.bounds, { x_m, y_m });
  run.places.push({ x_m, y_m, at });
  run.endAt = at;
}
