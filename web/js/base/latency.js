/** The round trip of a request, measured while somebody looks at the page. */

const EVERY_MS = 5000;

export class Latency {
  /** Newest round trip, ms; null: none was measured, or the last one had no answer. */
  roundTripMs = null;
  #measuredAt = -Infinity;
  #isMeasuring = false;

  /** Measure again if the last time is long enough ago. */
  async look(now = performance.now()) {
    if (this.#isMeasuring || document.hidden || now - this.#measuredAt < EVERY_MS) return;
    this.#isMeasuring = true;
    this.#measuredAt = now;
    this.roundTripMs = await roundTrip();
    this.#isMeasuring = false;
  }
}

async function roundTrip() {
  const began = performance.now();
  try {
    await fetch("/livez", { cache: "no-store", signal: AbortSignal.timeout(EVERY_MS) });
    return performance.now() - began;
  } catch {
    return null;
  }
}
