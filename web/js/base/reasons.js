/** Reasons why something is not so, as trees in words. */

import { el } from "/web/js/base/dom.js";
import { timeAndDay } from "/web/js/base/words.js";

const JOINT = " › ";

/** A list in which each reason stands above those that it follows from; root causes are marked.
 *
 * `plain` says a message in the words of the page; what quotes a condition stays as it is.
 */
export function reasonTree(blockers, plain = (text) => text) {
  return el("ul", { class: "reason-tree" }, ...blockers.map((blocker) => branch(blocker, plain)));
}

/** What is behind a condition with a single cause: "battery_level is 0.2, needs >= 0.3". */
export function nearestWords({ message, condition, causes = [] }) {
  return condition && causes.length === 1 ? nearestWords(causes[0]) : message;
}

function branch({ message, path, causes = [], root_cause, refuses, since_at, condition }, plain) {
  // The first is the part that was asked about, the last is named in the message.
  const between = path.slice(1, -1);
  const facts = [
    refuses === false ? "only a warning" : null,
    between.length ? `in ${between.join(JOINT)}` : null,
    since_at && causes.length === 0 ? `since ${timeAndDay(since_at)}` : null,
  ].filter(Boolean);
  return el(
    "li",
    {},
    el("span", {}, condition && message.includes(condition) ? message : plain(message)),
    root_cause ? el("span", { class: "root" }, "root cause") : null,
    facts.length ? el("span", { class: "facts" }, facts.join(", ")) : null,
    causes.length ? reasonTree(causes, plain) : null,
  );
}

/** The texts of all conditions that are not true, down to the leaves. */
export function conditionsIn(blockers) {
  return blockers.flatMap(({ condition, causes = [] }) => [
    ...(condition ? [condition] : []),
    ...conditionsIn(causes),
  ]);
}
