/** Which events the timeline shows, and how they are asked for. */

/** Name, query of `GET /events`, and whether an event belongs to it. */
const GROUPS = [
  ["state", "kind=system_state.changed", ({ kind }) => kind === "system_state.changed"],
  ["task", "kind=task", ({ kind }) => kind.startsWith("task.")],
  ["errors", "kind=error", ({ kind }) => kind.startsWith("error.")],
  ["holds", "kind=hold", ({ kind }) => kind.startsWith("hold.")],
  ["requests", "kind=*requested", ({ kind }) => kind.endsWith("requested")],
  ["stops", "kind=emergency_stop", ({ kind }) => kind.startsWith("emergency_stop.")],
  ["audit", "kind=audit.write", ({ kind }) => kind === "audit.write"],
  ["runs", "kind=service", ({ kind }) => kind.startsWith("service.")],
];
const ACTUAL = "part.actual_changed";

/** The groups that every timeline has, without events. */
export function commonGroups() {
  return Object.fromEntries(GROUPS.map(([name, query, takes]) => [name, emptyGroup(query, takes)]));
}

/** The states and modes of one part. */
export function groupOfPart(part) {
  const query = `kind=${ACTUAL}&part=${encodeURIComponent(part)}`;
  return emptyGroup(query, ({ kind, data }) => kind === ACTUAL && data.part === part);
}

/** `from` is the time from which its events are there; full: it has more before; stale: within. */
function emptyGroup(query, takes) {
  const unread = { from: Infinity, isFull: false, isStale: false, isLoading: false };
  return { query, takes, events: [], ...unread };
}
