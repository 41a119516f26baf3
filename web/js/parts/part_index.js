/** What is known of all parts at once: how they hang together, and which of them need attention.
 *
 * A frame replaces the objects of the parts that it changes, so everything here is compared by
 * identity: a frame that changes 50 of 1,000 parts costs 1,000 comparisons.
 */

import { isOn, isSilenced } from "/web/js/base/error_groups.js";
import { isSame } from "/web/js/base/same.js";
import { ATTENTION, lookOf, RANKS } from "/web/js/parts/verdict.js";

/** Return how the parts hang together; the previous answer as long as nothing of that changed.
 *
 * `roots`, `order` (each part once, systems before what they contain), `below` (of each system, all
 * that it contains, each once), `nodes` (in the order of the tree) and `children`.
 */
export function structureOf(parts, before = null) {
  if (before && isSameStructure(parts, before)) {
    before.parts = parts;
    return before;
  }
  const names = Object.keys(parts);
  const children = new Map();
  for (const name of names)
    children.set(name, (parts[name].parts ?? []).filter((child) => parts[child]));
  const owned = new Set([...children.values()].flat());
  const roots = names.filter((name) => !owned.has(name));
  const order = new Set();
  const below = new Map();
  const visit = (name) => {
    if (below.has(name)) return below.get(name);
    order.add(name);
    const found = new Set();
    for (const child of children.get(name)) {
      found.add(child);
      for (const deeper of visit(child)) found.add(deeper);
    }
    below.set(name, [...found]);
    return below.get(name);
  };
  roots.forEach(visit);
  const nodes = [...order].filter((name) => children.get(name).length === 0);
  return { parts, names, roots, children, below, order: [...order], nodes };
}

function isSameStructure(parts, { parts: known, names, children }) {
  if (parts === known) return true;
  let count = 0;
  for (const name in parts) {
    count += 1;
    const [part, was] = [parts[name], known[name]];
    if (part === was) continue;
    if (!was || !isSame(part.parts ?? [], was.parts ?? [])) return false;
  }
  return count === names.length && children.size === count;
}

/** Return by part the device that it is on as a whole; parts of this computer are not in it. */
export function devicesOf({ parts, order, below }) {
  const found = new Map();
  for (const name of order) {
    const nodes = [name, ...below.get(name)].filter((each) => parts[each].kind === "node");
    const { device } = parts[nodes[0]] ?? {};
    if (device && nodes.every((node) => parts[node].device === device)) found.set(name, device);
  }
  return found;
}

const NONE = [];

/** Return the errors that are on and wanted, by part. */
export function errorsByPart(errors) {
  const found = new Map();
  for (const error of Object.values(errors)) {
    if (error.part === null || !isOn(error) || isSilenced(error)) continue;
    if (!found.has(error.part)) found.set(error.part, []);
    found.get(error.part).push(error);
  }
  return found;
}

/** Keeps the look of each part, and for each system the worst below it. */
export class Looks {
  /** name -> {part, errors, look} */
  #known = new Map();
  /** name -> {worst, count}: of the parts below in which attention begins. */
  #below = new Map();
  /** Those that need attention, the worst first; where it begins before what follows from it. */
  attention = NONE;
  /** Those of them with nothing below that needs attention. */
  begins = new Set();

  /** Take the parts and their errors; return whether any look changed. */
  take(structure, errors) {
    const { parts, order } = structure;
    let isChanged = this.structure !== structure;
    if (isChanged) this.#known = new Map();
    this.structure = structure;
    for (const name of order) {
      const [part, told, known] = [parts[name], errors.get(name) ?? NONE, this.#known.get(name)];
      if (known?.part === part && known.errors === told) continue;
      const look = lookOf(part, told);
      if (known?.look !== look) isChanged = true;
      this.#known.set(name, { part, errors: told, look });
    }
    if (isChanged) this.#rollUp(structure);
    return isChanged;
  }

  look(name) {
    return this.#known.get(name)?.look ?? "unknown";
  }

  errors(name) {
    return this.#known.get(name)?.errors ?? NONE;
  }

  /** Return `{worst, count}` of what is below a system, or null where nothing needs attention. */
  below(name) {
    return this.#below.get(name) ?? null;
  }

  #rank(name) {
    return RANKS[this.look(name)];
  }

  #rollUp({ order, below }) {
    const isWanting = (name) => this.#rank(name) >= ATTENTION;
    const wanting = order.filter(isWanting);
    this.begins = new Set(wanting.filter((name) => !below.get(name).some(isWanting)));
    const known = this.#below;
    this.#below = new Map();
    for (const [name, deeper] of below) {
      const [worst, count] = this.#worstOf(deeper);
      if (count === 0) continue;
      const was = known.get(name);
      // The same object, so that its row is left alone.
      const isKept = was?.worst === worst && was.count === count;
      this.#below.set(name, isKept ? was : { worst, count });
    }
    const groups = [];
    for (const name of wanting) (groups[this.#urgency(name)] ??= []).push(name);
    this.attention = groups.reverse().flat();
  }

  /** Return the worst look of those in which attention begins, and how many they are. */
  #worstOf(names) {
    let [worst, count] = ["normal", 0];
    for (const name of names) {
      if (!this.begins.has(name)) continue;
      count += 1;
      if (this.#rank(name) > RANKS[worst]) worst = this.look(name);
    }
    return [worst, count];
  }

  #urgency(name) {
    const rank = this.#rank(name);
    return (rank >= RANKS.faulty ? 20 : 0) + (this.begins.has(name) ? 10 : 0) + rank;
  }
}
