/** The order of signals: what is urgent first, then by name. */

import { urgency } from "/web/js/base/signal_words.js";

const RANKS = ["error", "pending", "stale", "unknown", "ok"];

/** 0 for what is most urgent. */
export function rank(signal) {
  const level = RANKS.indexOf(urgency(signal));
  // What was never sent is no news.
  return Math.min(level, 3);
}

/** Compare two rows for sorting. */
export function byUrgency(a, b) {
  return a.rank - b.rank || COLLATOR.compare(a.label, b.label);
}

/** "5", or "200 · 1 error · 2 pending". */
export function countWords(rows, shown) {
  const count = (wanted) => rows.filter(({ rank: own }) => own === wanted).length;
  const errors = count(0);
  const words = [
    shown === rows.length ? `${shown}` : `${shown} of ${rows.length}`,
    errors ? `${errors} ${errors === 1 ? "error" : "errors"}` : "",
    count(1) ? `${count(1)} pending` : "",
    count(2) ? `${count(2)} stale` : "",
  ];
  return words.filter(Boolean).join(" · ");
}

const COLLATOR = new Intl.Collator("en", { numeric: true, sensitivity: "base" });
