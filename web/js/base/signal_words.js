/** Texts on signals: pure functions. `api/cli/monitor/words.py` has the same rules. */

import { describe } from "/web/js/base/signal_catalog.js";
import { duration, modeName } from "/web/js/base/words.js";

const SOON_OLD_MS = 5000;

/** The value as `[text, unit, aside]`; the stop is engaged whatever its signal says. */
export function valueWords(name, signal, emergencyStop) {
  const [text, unit] = signal.value === null ? ["?", ""] : describe(name, signal).show(signal.value);
  const isStop = name === "estop" && emergencyStop?.engaged;
  return isStop ? ["stop engaged", "", `signal: ${text}`] : [text, unit, ""];
}

/** How urgent a signal is: "error", "pending", "stale", "unknown" or "ok". */
export function urgency({ error, stale, pending, received_at }) {
  if (error && error !== "STALE_DATA") return "error";
  if (pending) return "pending";
  if (stale || error) return "stale";
  return received_at ? "ok" : "unknown";
}

/** How good the signal is, as `{level, text}`; `now` in ms by the server's clock. */
export function verdict(signal, isLive, now) {
  const { error, stale, pending } = signal;
  const errors = [error, stale && error !== "STALE_DATA" ? "stale" : null].filter(Boolean).join(", ");
  if (!isLive) return { level: "unknown", text: errors ? `was ${errors}` : "no contact" };
  const level = urgency(signal);
  if (level === "pending") {
    const left = Math.ceil(pending.needs_s - pendingFor(pending, now));
    return { level, text: [errors, `${pending.error} in ${left} s`].filter(Boolean).join(", ") };
  }
  return { level, text: errors || (level === "ok" ? "OK" : "no data") };
}

/** How long an error has been pending, s; at most what it needs. */
export function pendingFor({ since_at, needs_s }, now) {
  return Math.max(0, Math.min((now - Date.parse(since_at)) / 1000, needs_s));
}

/** "9 of 15 s": how far a pending error is. */
export function pendingWords(pending, now) {
  return `${Math.floor(pendingFor(pending, now))} of ${Math.round(pending.needs_s)} s`;
}

/** Age of a reading that is older than it should be; empty for one that is not.
 *
 * Without contact each is.
 */
export function ageWords({ received_at, stale, settings }, isLive, now) {
  if (!received_at) return "never received";
  const age = now - Date.parse(received_at);
  const limit = settings?.stale_after_s ? settings.stale_after_s * 500 : SOON_OLD_MS;
  return isLive && !stale && age < Math.max(limit, 1000) ? "" : `${duration(age)} old`;
}

/** A message with signals called by their labels, and modes as on the page. */
export function plainMessage(message, signals) {
  return message.replace(/[\w/]+/g, (word) =>
    Object.hasOwn(signals, word) ? describe(word, signals[word]).label : modeName(word),
  );
}
