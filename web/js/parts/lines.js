/** The lines of the lists of parts: pure functions of the structure of the parts.
 *
 * A line has `key`, `name` (of the part), `shown` and `space` (its last word, and the namespace before
 * that; "" where a heading above tells it), `level`, `index` and `count` (place among its siblings,
 * from 1), and `open` (null: it contains nothing). A heading has `heading` and no `name`.
 */

// Paths are joined by a character that no name contains; names may contain slashes.
const JOINT = "\n";

export function parentOf(key) {
  return key.slice(0, Math.max(0, key.lastIndexOf(JOINT)));
}

/** Return the name of the part that a line of this key is of. */
export function nameOf(key) {
  return key.slice(key.lastIndexOf(JOINT) + 1);
}

/** Return the lines of the tree; `isOpen(key, name, level)` decides about systems, `shown` about all.
 *
 * `shown`: the names that are let through, with all above them; null: every part.
 */
export function treeLines({ roots, children }, isOpen, shown = null) {
  const lines = [];
  const add = (names, parent, level) => {
    const seen = shown ? names.filter((name) => shown.has(name)) : names;
    let index = 0;
    for (const { space, members } of byNamespace(seen)) {
      const isHeaded = members.length > 1 && space !== "";
      if (isHeaded) lines.push({ key: `${parent}${JOINT}${space}/`, heading: space, level });
      for (const name of members) {
        const key = parent ? parent + JOINT + name : name;
        const below = children.get(name).filter((child) => !shown || shown.has(child));
        const open = below.length > 0 ? isOpen(key, name, level) : null;
        const words = { shown: lastWord(name), space: isHeaded ? "" : space };
        lines.push({ key, name, ...words, level, open, index: ++index, count: seen.length });
        if (open) add(below, key, level + 1);
      }
    }
  };
  add(roots, "", 1);
  return lines;
}

/** Return siblings in groups; those that share a namespace stand together where the first stood. */
function byNamespace(names) {
  const groups = new Map();
  for (const name of names) {
    const space = namespaceOf(name);
    // Without a namespace each one keeps its place.
    const key = space ? `${space}/` : name;
    if (!groups.has(key)) groups.set(key, { space, members: [] });
    groups.get(key).members.push(name);
  }
  return [...groups.values()];
}

function namespaceOf(name) {
  return name.slice(0, Math.max(0, name.lastIndexOf("/")));
}

/** Return a name without its namespace. */
export function lastWord(name) {
  return name.slice(name.lastIndexOf("/") + 1);
}

/** Return the lines of a flat list. */
export function flatLines(names) {
  const shared = { open: null, count: names.length };
  return names.map((name, at) => {
    const words = { shown: lastWord(name), space: namespaceOf(name) };
    return { key: name, name, ...words, index: at + 1, ...shared };
  });
}

/** Return whether all words of a text are in the name, in any order and case. */
export function matches(name, words) {
  const lower = name.toLowerCase();
  return words.every((word) => lower.includes(word));
}

/** Return the names that match and all that the tree needs to show them.
 *
 * `found` match themselves; `kept` are those, what they contain, and what leads to them; `leading`
 * contain something that matches.
 */
export function filtered({ order, below }, words) {
  const found = new Set(order.filter((name) => matches(name, words)));
  const kept = new Set(found);
  const leading = new Set();
  for (const name of order) {
    const deeper = below.get(name);
    if (deeper.length === 0) continue;
    if (found.has(name)) for (const each of deeper) kept.add(each);
    if (!deeper.some((each) => found.has(each))) continue;
    leading.add(name);
    kept.add(name);
  }
  return { found, kept, leading };
}

/** Names up to this length have no end of their own; the end of others has at most so many. */
const [SHORT, END] = [12, 8];

/** Split a name into what may give way to an ellipsis, and the end that tells it from others. */
export function splitName(name) {
  if (name.length <= SHORT) return [name, ""];
  const mark = name.search(/[_.-][^_.-]*$/);
  const at = mark >= name.length - END ? mark : name.length - END + 2;
  return [name.slice(0, at), name.slice(at)];
}
