/** What is not as it should be with parts: pure functions, computed once for each set of parts. */

import { deviceProblems, isAway } from "/web/js/base/device_words.js";
import { label } from "/web/js/base/words.js";

const NAMED = 3;
const NONE = {};
const found = new WeakMap();

/** What is wrong with parts, the first few: "lidar is unreachable", "2 more such parts".
 *
 * A device that is away stands for all parts of it.
 */
export function partProblems(parts, devices = NONE) {
  return [...deviceProblems(devices), ...problemsOf(parts, devices).texts];
}

/** How many parts there are, how many of them deviate, and how many are unreachable. */
export function partCounts(parts, devices = NONE) {
  return problemsOf(parts, devices).counts;
}

function problemsOf(parts, devices) {
  if (found.get(parts)?.devices !== devices) found.set(parts, { devices, ...findProblems(parts, devices) });
  return found.get(parts);
}

function findProblems(parts, devices) {
  const problems = new Map();
  const isExplained = (part) =>
    (part.parts ?? []).some((name) => problems.has(name) || (parts[name] && isExplained(parts[name])));
  const all = Object.values(parts);
  const counts = { total: all.length, deviating: 0, unreachable: 0 };
  // Nodes first: they explain why their systems deviate.
  for (const kind of ["node", "system"]) {
    for (const part of all) {
      if (part.kind !== kind) continue;
      const words = problemOf(part);
      if (!words || (kind === "system" && isExplained(part))) continue;
      problems.set(part.name, isAway(devices[part.device]) ? null : words);
      if (part.reachable === false) counts.unreachable += 1;
      else counts.deviating += 1;
    }
  }
  const texts = [...new Set(problems.values())].filter(Boolean);
  const left = texts.length - NAMED;
  return { counts, texts: left > 0 ? [...texts.slice(0, NAMED), `${left} more such ${left === 1 ? "part" : "parts"}`] : texts };
}

function problemOf(part) {
  const { name, kind, actual, change, converged } = part;
  if (part.reachable === false && kind !== "system") return `${name} is unreachable`;
  if (actual.state === "errorprocessing") return `${name} is in errorprocessing`;
  const target = part.effective_target ?? part.target;
  if (converged || change || !target) return null;
  const is = actual.state === "unknown" ? "in an unknown state" : label(actual);
  return part.deviation_reason ?? `${name} is ${is}, target ${label(target)}`;
}
