/** Texts on signals: pure functions. `api/cli/monitor/words.py` has the same rules. */

import { describe } from "/web/js/base/signal_catalog.js";
import { duration, modeName } from "/web/js/base/words.js";

/** The value as `[text, unit]`; the stop is engaged whatever its signal says. */
export function valueWords(name, signal, emergencyStop) {
  const [text, unit] = signal.value === null ? ["?", ""] : describe(name, signal.unit).show(signal.value);
  return name === "estop" && emergencyStop?.engaged ? ["stop engaged", `(signal: ${text})`] : [text, unit];
}

/** How good the signal is, as `{level, text}`; `now` in ms by the server's clock. */
export function verdict({ error, stale, pending, received_at }, isLive, now) {
  const errors = [error, stale && error !== "STALE_DATA" ? "STALE" : null].filter(Boolean).join(", ");
  if (!isLive) return { level: "unknown", text: errors ? `was ${errors}` : "no contact" };
  if (errors) return { level: "error", text: `⚠ ${errors}` };
  if (pending) {
    const left = Math.ceil(pending.needs_s - pendingFor(pending, now));
    return { level: "pending", text: `${pending.error} in ${left} s` };
  }
  return received_at ? { level: "ok", text: "OK" } : { level: "unknown", text: "no data" };
}

/** How long an error has been pending, s; at most what it needs. */
export function pendingFor({ since_at, needs_s }, now) {
  return Math.min((now - Date.parse(since_at)) / 1000, needs_s);
}

/** Age of a reading; without contact also that of a young one is told. */
export function ageWords({ received_at, stale }, isLive, now) {
  if (!received_at) return "never received";
  const age = now - Date.parse(received_at);
  return age < 1000 && !stale && isLive ? "now" : `${duration(age)} old`;
}

/** A message with signals called by their labels, and modes as on the page. */
export function plainMessage(message, signals) {
  return message.replace(/[\w/]+/g, (word) =>
    Object.hasOwn(signals, word) ? describe(word, signals[word].unit).label : modeName(word),
  );
}
