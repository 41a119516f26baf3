/** The server's clock as estimated here, in ms since 1970. */

const WINDOW_MS = 10_000;

/** Local time that never jumps, in ms since 1970. */
export function localNow() {
  return performance.timeOrigin + performance.now();
}

/** Estimates the offset between our clock and the server's from the times in its frames.
 *
 * Transmission can only delay a frame, so the smallest offset of the last 10 to 20 s is the most
 * accurate. Older ones are dropped, since either clock may be set.
 */
export class ServerClock {
  #windowStart = -Infinity;
  #smallest = Infinity;
  #smallestBefore = Infinity;

  observe(at, local = localNow()) {
    if (local - this.#windowStart > WINDOW_MS) {
      this.#smallestBefore = this.#smallest;
      this.#smallest = Infinity;
      this.#windowStart = local;
    }
    this.#smallest = Math.min(this.#smallest, local - Date.parse(at));
  }

  now(local = localNow()) {
    const offset = Math.min(this.#smallest, this.#smallestBefore);
    return Number.isFinite(offset) ? local - offset : local;
  }
}
