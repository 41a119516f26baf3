/** What else may happen in a scenario: kinds of steps, their choices and words. */

import { modeName } from "/web/js/base/words.js";

const FAULTS = [
  ["die", "dies"],
  ["silent", "stops reporting"],
  ["refuse", "refuses what is asked"],
  ["fail", "fails what is asked"],
  ["slow", "gets slow"],
  ["error", "goes into error processing"],
  ["recover", "recovers"],
];
const OWN_HOLD = "operator";
const NOT_OURS = ["error", "vehicle"];

/** Kinds by name: `{words, targets(state) -> [[value, words]], options(target), step, said}`.
 *
 * `step(target, option)` is what is asked of the simulation, `said(target, option)` its words.
 */
export const KINDS = {
  fault: {
    words: "A node fails",
    targets: ({ parts }) => ofKind(parts, "node"),
    options: async () => FAULTS,
    step: (node, fault) => ({ node, fault }),
    said: (node, fault) => `${node} ${wordsOf(FAULTS, fault)}`,
  },
  mode: {
    words: "A mode is requested",
    targets: ({ parts }) => [...ofKind(parts, "system"), ...ofKind(parts, "node")],
    options: (part, modesOf) => modesOf(part),
    step: (part, mode) => ({ change: { part, mode } }),
    said: (part, mode) => `${part}: mode ${modeName(mode)} requested`,
  },
  hold: {
    words: "A hold is set or released",
    targets: ({ holds }) => [
      [OWN_HOLD, `${OWN_HOLD} (set)`],
      ...Object.keys(holds)
        .filter((owner) => !NOT_OURS.includes(owner))
        .map((owner) => [`-${owner}`, `${owner} (released)`]),
    ],
    step: (owner) =>
      owner.startsWith("-")
        ? asked("DELETE", `/holds/${encodeURIComponent(owner.slice(1))}`)
        : asked("PUT", `/holds/${owner}`, { reason: "simulation" }),
    said: (owner) => (owner.startsWith("-") ? `hold ${owner.slice(1)} released` : `hold ${owner} set`),
  },
  task: {
    words: "The task is canceled",
    step: () => ({ task: null }),
    said: () => "task canceled",
  },
  stop: {
    words: "STOP is pressed",
    step: () => asked("PUT", "/emergency_stop", { engaged: true, reason: "simulation" }),
    said: () => "STOP pressed",
  },
  vehicle: {
    words: "The vehicle stops reporting",
    step: () => ({ vehicle: "silent" }),
    said: () => "the vehicle stops reporting its pose",
  },
};

function asked(method, path, body) {
  return { request: { method, path, ...(body ? { body } : {}) } };
}

function ofKind(parts, kind) {
  const found = Object.values(parts).filter((part) => part.kind === kind);
  return found.map(({ name }) => [name, name]);
}

function wordsOf(choices, value) {
  return choices.find(([own]) => own === value)[1];
}
