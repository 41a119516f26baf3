/** What a part needs of an operator: pure functions of a part and of its errors that are on. */

import { label } from "/web/js/base/words.js";

/** How urgent each look is; an operator has to attend to those from ATTENTION on. */
export const RANKS = {
  normal: 0,
  changing: 1,
  unknown: 2,
  warned: 3,
  deviating: 4,
  faulty: 5,
  unreachable: 6,
};
export const ATTENTION = RANKS.warned;

/** What a dot or a square tells besides its shape and colour; what is normal needs no word. */
export const LOOK_WORDS = {
  normal: "",
  changing: "changing",
  unknown: "state not known",
  warned: "warning",
  deviating: "deviates",
  faulty: "faulty",
  unreachable: "unreachable",
};

const NONE = [];
/** These say of a part what its target and its actual state say already. */
const OF_THE_TARGET = new Set(["DEVIATES", "CHANGE_FAILED"]);

/** Return the look of a part, a key of RANKS. */
export function lookOf(part, errors = NONE) {
  if (part.reachable === false && part.kind === "node") return "unreachable";
  const told = errors.filter(({ error }) => !OF_THE_TARGET.has(error));
  if (told.some(({ severity }) => severity !== "warning")) return "faulty";
  if (!part.converged && !part.change) return "deviating";
  if (told.length > 0) return "warned";
  if (part.change) return "changing";
  return part.actual.state === "unknown" ? "unknown" : "normal";
}

/** Return why a part needs attention, in one line; "" where its pill says all that is known. */
export function causeWords(part, errors = NONE) {
  const told = errors.find(({ error }) => !OF_THE_TARGET.has(error));
  if (told) return errorWords(told);
  if (part.reachable === false && part.kind === "node") return "unreachable";
  const elsewhere = part.deviation_reason;
  if (elsewhere && !elsewhere.startsWith(`${part.name} is `)) return `because ${nearest(elsewhere)}`;
  if (part.actual.reason) return part.actual.reason;
  const failed = errors.find(({ error }) => error === "CHANGE_FAILED");
  if (failed?.message) return failed.message;
  return part.converged ? "" : `is ${isIn(part)}, and no change is under way`;
}

/** What follows from another error names that; else the error says what it is. */
function errorWords({ part, error, message, caused_by: causes = NONE }) {
  const cause = causes[0];
  if (cause) return `because ${cause.part === null ? "of" : cause.part} ${cause.error}`;
  // The row has the name of the part already.
  const own = part && message?.startsWith(`${part} `) ? message.slice(part.length + 1) : message;
  return own ? `${error}: ${own}` : error;
}

/** "camera is active.SLOW, target active.FAST" without what the pill of that part tells. */
function nearest(reason) {
  return reason.replace(/, target \S+$/, "");
}

function isIn({ actual }) {
  return actual.state === "unknown" ? "in an unknown state" : label(actual);
}

/** Return the target that a part does not meet, or null. */
export function missedTarget({ target, effective_target: effective, actual, converged }) {
  const wanted = effective ?? target;
  // A system may be where its target says while its parts are not: its cause tells which.
  const isThere = wanted?.state === actual.state && wanted?.mode === actual.mode;
  return converged || !wanted || isThere ? null : wanted;
}
