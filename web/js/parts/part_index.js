/** What is known of all parts at once: how they hang together, and which of them need attention.
 *
 * A frame replaces the objects of the parts that it changes, so everything here is compared by
 * identity: a frame that changes 50 of 1,000 parts costs 1,000 comparisons.
 */

import { isOn, isSilenced } from "/web/js/base/error_groups.js";
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
    below.set(name, found);
    for (const child of children.get(name)) {
      found.add(child);
      for (const deeper of visit(child)) found.add(deeper);
    }
    return found;
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
    if (!was || !isSameList(part.parts ?? [], was.parts ?? [])) return false;
  }
  return count === names.length && children.size === count;
}

function isSameList(one, other) {
  return one.length === other.length && one.every((item, index) => item === other[index]);
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
    const wanting = order.filter((name) => this.#rank(name) >= ATTENTION);
    const isWanting = new Set(wanting);
    const begins = (this.begins = new Set(
      wanting.filter((name) => ![...below.get(name)].some((deeper) => isWanting.has(deeper))),
    ));
    this.#below = new Map();
    for (const [name, deeper] of below) {
      const found = deeper.size === 0 ? NONE : [...begins].filter((one) => deeper.has(one));
      if (found.length === 0) continue;
      const worst = found.reduce((a, b) => (this.#rank(b) > this.#rank(a) ? b : a));
      this.#below.set(name, { worst: this.look(worst), count: found.length });
    }
    const urgency = (name) => {
      const rank = this.#rank(name);
      return (rank >= RANKS.faulty ? 20 : 0) + (begins.has(name) ? 10 : 0) + rank;
    };
    this.attention = wanting.sort((a, b) => urgency(b) - urgency(a));
  }
}
