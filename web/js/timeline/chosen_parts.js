/** Which parts have lanes: all of a small robot, else the selected one and those that are kept. */

const ALL_UP_TO = 6;
const MOST = 8;
const KEY = "pilothouse.timeline.parts";

/** Names of parts with a lane, systems first. */
export function chosenParts(parts, selected, kept) {
  const all = Object.values(parts);
  const isAll = all.length <= ALL_UP_TO;
  const wanted = new Set(isAll ? Object.keys(parts) : [selected, ...kept]);
  const chosen = [...wanted].filter((name) => parts[name]).slice(0, MOST);
  const rank = (name) => (parts[name].kind === "system" ? 0 : 1);
  return { names: chosen.sort((a, b) => rank(a) - rank(b)), isAll };
}

/** The parts that the operator keeps on the timeline; of this browser. */
export function loadKept() {
  try {
    const kept = JSON.parse(localStorage.getItem(KEY) ?? "[]");
    return Array.isArray(kept) ? kept.filter((name) => typeof name === "string") : [];
  } catch {
    return [];
  }
}

/** Remember what is kept, if the browser allows it. */
export function storeKept(kept) {
  try {
    localStorage.setItem(KEY, JSON.stringify(kept.slice(0, MOST)));
  } catch {
    // Then it is kept until the page is closed.
  }
}
