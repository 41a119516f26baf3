/** The way of a stop: sent, acknowledged, standstill, each with its time. */

import { el, renderOnce } from "/web/js/base/dom.js";
import { timeOfDay } from "/web/js/base/words.js";

/** Return the steps as `{name, text}`; a step that is still to come has the text "…".
 *
 * `sentAt` and `answeredAt` are of this page, `at` is when the service engaged it (ms since 1970;
 * null: unknown). A stop that somebody else sent begins with its engagement.
 */
export function stopSteps(latch, { sentAt, answeredAt, at }) {
  const begun =
    sentAt === null
      ? [{ name: "ENGAGED", text: at === null ? "…" : timeOfDay(at) }]
      : [
          { name: "SENT", text: timeOfDay(sentAt) },
          { name: "ACKNOWLEDGED", text: answeredAt === null ? "…" : after(answeredAt - sentAt) },
        ];
  const stood = latch?.engaged && latch.standstill_at ? Date.parse(latch.standstill_at) : null;
  const text = stood === null || at === null ? "…" : after(stood - at);
  return [...begun, { name: "STANDSTILL", text }];
}

/** Draw the steps into a list, if they changed. */
export function drawSteps(list, steps) {
  renderOnce(list, JSON.stringify(steps), () =>
    steps.map(({ name, text }) =>
      el("li", { "data-open": text === "…" }, el("strong", {}, name), el("span", {}, text)),
    ),
  );
}

/** "+0.08 s" after the step before. */
function after(ms) {
  const seconds = Math.max(0, ms) / 1000;
  return `+${seconds.toFixed(seconds < 1 ? 2 : 1)} s`;
}
