/** What the answers about a part were made of: as long as it stays the same, so do they. */

import { conditionsIn } from "/web/js/base/reasons.js";

/** What blockers are made of: the part and all below it, the errors with their reasons, the stop.
 *
 * Parts that a frame leaves out stay the same objects, so this is cheap to compare.
 */
export function whatDecides(part, { parts, systemState, errors, emergencyStop }) {
  const reasons = (systemState?.reasons ?? []).map(({ code, message }) => `${code}: ${message}`);
  const below = new Set();
  const add = (one) => {
    if (!one || below.has(one)) return;
    below.add(one);
    for (const name of one.parts ?? []) add(parts[name]);
  };
  add(part);
  return [...below, errors, reasons.join("\n"), Boolean(emergencyStop?.engaged)];
}

/** The facts that the conditions of the modes name: readings and parts anywhere, the drive. */
export function whatIsNamed({ modes, why }, { signals, parts, task, vehicle, holds }) {
  const blockers = [...modes.flatMap((mode) => mode.blockers), ...(why?.blockers ?? [])];
  const guards = modes.flatMap(({ requires = [], invariants = [] }) => [...requires, ...invariants]);
  const text = [...guards, ...conditionsIn(blockers)].join("\n");
  if (!text) return [];
  const named = (members) =>
    Object.values(members).filter((one) => text.includes(one.signal ?? one.name));
  return [
    ...named(signals).flatMap(({ value, stale, error }) => [value, stale, error]),
    ...named(parts),
    ...(text.includes("task.") ? [task] : []),
    ...(text.includes("vehicle.") ? [vehicle] : []),
    ...(text.includes("hold") ? [holds] : []),
  ];
}
