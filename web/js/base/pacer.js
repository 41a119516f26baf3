/** Decides when to draw: at most at 10 Hz, at once when it is urgent, never while nobody looks. */

const PAUSE_MS = 100;

export class Pacer {
  #draw;
  #drawnAt = -Infinity;
  #timer = null;
  #isAsked = false;

  constructor(draw) {
    this.#draw = draw;
    document.addEventListener("visibilitychange", () => this.ask(true));
  }

  /** Draw in the next animation frame that is due. */
  ask(isUrgent = false) {
    if (document.hidden || this.#isAsked) return;
    const wait = isUrgent ? 0 : this.#drawnAt + PAUSE_MS - performance.now();
    if (wait <= 0) this.#request();
    else this.#timer ??= setTimeout(() => this.#request(), wait);
  }

  #request() {
    clearTimeout(this.#timer);
    this.#timer = null;
    if (this.#isAsked) return;
    this.#isAsked = true;
    requestAnimationFrame(() => {
      this.#isAsked = false;
      this.#drawnAt = performance.now();
      this.#draw();
    });
  }
}
