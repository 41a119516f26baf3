/** Draws at most ten times a second what moves by itself, and at once what a person moves. */

const LEAST_MS = 100;

export class Pace {
  #draw;
  #timer = null;
  #frame = null;
  #drawnAt = -Infinity;

  constructor(draw) {
    this.#draw = draw;
  }

  /** Draw as soon as the last picture is old enough. */
  soon() {
    if (this.#timer !== null || this.#frame !== null) return;
    const waitMs = this.#drawnAt + LEAST_MS - performance.now();
    if (waitMs <= 0) this.now();
    else this.#timer = setTimeout(() => this.now(), waitMs);
  }

  /** Draw in the next animation frame. */
  now() {
    clearTimeout(this.#timer);
    this.#timer = null;
    this.#frame ??= requestAnimationFrame(() => {
      this.#frame = null;
      this.#drawnAt = performance.now();
      this.#draw();
    });
  }
}
