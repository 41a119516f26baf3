/** What hold chips and the list of holds have in common. */

import { request } from "/web/js/base/api.js";

/** Ask for the release of the hold of `owner`; returns what went wrong, or an empty text. */
export async function releaseHold(owner, volatile) {
  const path = `/holds/${encodeURIComponent(owner)}`;
  try {
    await request("DELETE", volatile ? `${path}?volatile=true` : path);
    return "";
  } catch ({ message }) {
    return `Not released: ${message}`;
  }
}

/** What ends the holds that Pilothouse releases itself. */
const UNTIL = {
  error: "until the errors end",
  vehicle: "until there is a pose",
  drive_process: "until the vehicle can be commanded",
  navigation: "until its controller can be given a goal",
};

/** Whether a person may release it: Pilothouse clears its own holds, but for that of a restart. */
export function isReleasable({ owner }) {
  return !(owner in UNTIL) && !owner.startsWith("reaction:");
}

/** "by anna", "until the errors end"; empty: who set it is who owns it. */
export function whoseWords({ owner, by }) {
  if (by) return by === owner ? "" : `by ${by}`;
  if (owner.startsWith("reaction:")) return "until that is over";
  return UNTIL[owner] ?? (owner === "restart" ? "by Pilothouse" : "");
}

/** Names a hold: one that was released and set again is another one. */
export function holdKey({ owner, by, since_at }) {
  return JSON.stringify([owner, by, since_at]);
}
