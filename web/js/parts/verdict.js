/** What a part needs of an operator: pure functions of a part and of its errors that are on. */

import { label as words } from "/web/js/base/words.js";
import { lastWord } from "/web/js/parts/lines.js";

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
  // Of a change that was rolled back, target and actual state say nothing.
  const isTold = ({ error }) => !OF_THE_TARGET.has(error) || (error === "CHANGE_FAILED" && part.converged);
  const told = errors.filter(isTold);
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
  const { actual, change, converged } = part;
  const cause = [actual.reason, part.deviation_reason].map(stateOf).find((each) => each && each.name !== part.name);
  if (cause) return `because ${lastWord(cause.name)} is ${cause.is}`;
  if (actual.reason) return actual.reason;
  const failed = errors.find(({ error }) => error === "CHANGE_FAILED");
  if (failed?.message) return failed.message;
  const wanted = missedTarget(part);
  if (converged || !wanted) return "";
  return `target ${words(wanted)}, ${change ? "a change is under way" : "no change is under way"}`;
}

/** What follows from another error names that; else the error says what it is. */
function errorWords({ part, error, message, caused_by: causes = NONE }) {
  if (error === "UNREACHABLE" && !causes[0]) return own(part, message) || "unreachable";
  if (causes[0]?.error === "LOST") return `device ${causes[0].part} is lost`;
  const what = error.toLowerCase().replaceAll("_", " ");
  if (causes[0]) return `${what} because of ${[causes[0].part, causes[0].error].filter(Boolean).join(" ")}`;
  const said = own(part, message);
  return said ? `${what}: ${said}` : what;
}

/** A message without the name of the part, which its row has already. */
function own(part, message) {
  const said = message?.startsWith(`${part} `) ? message.slice(part.length + 1) : (message ?? "");
  return said.replaceAll("__DEFAULT__", "default");
}

/** Return `{name, is}` of a reason such as "arm/camera is active.SLOW, target active.FAST". */
function stateOf(reason) {
  const found = /^(\S+) is (?:active\.)?(.+?)(?:, target .*)?$/.exec(reason ?? "");
  return found && { name: found[1], is: found[2].replace("__DEFAULT__", "default") };
}

/** Return the target that a part does not meet, or null. */
export function missedTarget({ target, effective_target: effective, actual, converged }) {
  const wanted = effective ?? target;
  // A system may be where its target says while its parts are not: its cause tells which.
  const isThere = wanted?.state === actual.state && wanted?.mode === actual.mode;
  return converged || !wanted || isThere ? null : wanted;
}
