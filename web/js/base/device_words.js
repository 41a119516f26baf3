/** The computers of a robot in words: pure functions of what frames tell of them.
 *
 * `api/cli/monitor/device_words.py` has the same rules; one test runs both over the same cases.
 */

/** What each connection is called that is not as it should be, the worst first. */
const WORDS = { lost: "lost", conflict: "in conflict", never_seen: "not seen yet", late: "late" };
const RANKS = Object.keys(WORDS);
const NAMED = 3;

/** Whether nothing is known of what a device does now. */
export function isAway(device) {
  return device !== undefined && device.state !== "connected" && device.state !== "late";
}

/** The devices that are not as they should be, the worst first. */
export function amiss(devices) {
  return Object.values(devices)
    .filter(({ state }) => state in WORDS)
    .sort((a, b) => RANKS.indexOf(a.state) - RANKS.indexOf(b.state));
}

/** "arm lost", with the reason in full. */
export function chipWords({ device, state, reason }) {
  return { text: `${device} ${WORDS[state]}`, title: `Device ${device} is ${WORDS[state]}${reason ? `: ${reason}` : ""}` };
}

/** What the sentence says: "device arm is lost"; one that is only late is not worth one. */
export function deviceProblems(devices) {
  const away = amiss(devices).filter(isAway);
  const told = away.slice(0, NAMED).map(({ device, state }) => `device ${device} is ${WORDS[state]}`);
  return away.length > NAMED ? [...told, `${away.length - NAMED} more such devices`] : told;
}

/** "arm and base are not known to be stopped"; "" while all devices are heard. */
export function notStoppedWords(devices) {
  const names = amiss(devices).filter(isAway).map(({ device }) => device);
  if (names.length === 0) return "";
  return `${named(names)} ${names.length === 1 ? "is" : "are"} not known to be stopped`;
}

/** "STOP may not reach arm"; "" while all devices are heard. */
export function notReachedWords(devices) {
  const names = amiss(devices).filter(isAway).map(({ device }) => device);
  return names.length > 0 ? `STOP may not reach ${named(names)}` : "";
}

/** "at device arm (not heard) and here": where a stop is engaged; "" while that is only here. */
export function stopPlaces({ stops = [], not_heard: silent = [] }) {
  const places = [...new Set(stops.map(({ device }) => device))];
  if (places.every((device) => device === null)) return "";
  return named(places.map((device) => placeOf(device) + (silent.includes(device) ? " (not heard)" : "")));
}

function placeOf(device) {
  if (device === null) return "here";
  return device === "supervisor" ? "at the supervisor" : `at device ${device}`;
}

function named(names) {
  const first = names.length > NAMED ? [...names.slice(0, NAMED), `${names.length - NAMED} more`] : names;
  const last = first.at(-1);
  return first.length === 1 ? last : `${first.slice(0, -1).join(", ")} and ${last}`;
}

/** When a device that is away was heard last, ms; null: it is heard, or never was. */
export function heardLast(device) {
  const at = isAway(device) ? (device.heard_at ?? device.since_at) : null;
  return at && device.state !== "never_seen" ? Date.parse(at) : null;
}

const LEADS = {
  nobody: "no supervisor yet",
  supervisor: "the supervisor's word counts",
  cut_off: "cut off",
  device: "acts alone",
};

/** On the page of a device: which it is, and whose word counts. */
export function ownWords({ device, lead }) {
  return `${device}: ${LEADS[lead]}`;
}

/** What a device would do by itself: "When cut off for 2 s, drive_base goes to inactive." */
export function offlineWords({ after_s: after, target, reactions }, part) {
  const own = target[part] ? [[part, target[part]]] : [];
  const all = [...own, ...Object.entries(target).filter(([name]) => name !== part)];
  const goes = all.slice(0, NAMED).map(([name, label]) => `${name} goes to ${label.replace("__DEFAULT__", "default")}`);
  if (all.length > NAMED) goes.push(`${all.length - NAMED} more parts change`);
  if (reactions) goes.push("its reactions act");
  if (goes.length === 0) return "When cut off, it stays as it is.";
  return `When cut off for ${after} s, ${goes.join(", ")}.`;
}
