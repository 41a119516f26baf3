/** Errors as an operator reads them: roots with what follows from each, and what needs nobody now.
 *
 * Pure functions of the errors in frames.
 */

const SEVERITIES = ["fatal", "critical", "urgent", "warning"];
/** What needs somebody first. */
const URGENCY = { active: 0, latched: 0, acknowledged: 1, returned: 2, normal: 3 };
const ON = new Set(["active", "acknowledged", "latched"]);

export function isOn({ state }) {
  return ON.has(state);
}

/** Whether the robot stops its task for it. */
export function isGrave({ severity }) {
  return severity === "critical" || severity === "fatal";
}

/** Whether nobody has acknowledged it in its present state. */
export function isWaiting({ state }) {
  return state === "active" || state === "latched" || state === "returned";
}

/** Shelved, or silenced by the model. */
export function isSilenced({ suppressed, shelved_until_at }) {
  return suppressed || shelved_until_at !== null;
}

/** Whether somebody has to attend to it soon, and it follows from no other. */
export function isPressing(error) {
  return isOn(error) && error.root_cause && error.severity !== "warning" && !isSilenced(error);
}

/** "BATTERY_LOW", or "lidar.SILENT" for an error of a part. */
export function errorName({ part, error }) {
  return part === null ? error : `${part}.${error}`;
}

/** Return the errors in groups; those that are pending are none yet.
 *
 * `on` and `returned` have `{error, below}`, the roots with what follows from each; what follows from
 * a silenced error is silenced with it.
 */
export function errorGroups(errors) {
  const listed = Object.values(errors).filter(({ state }) => state !== "pending");
  const roots = new Map();
  for (const error of listed) if (error.root_cause) roots.set(errorName(error), { error, below: [] });
  const alone = [];
  for (const error of listed) {
    if (error.root_cause) continue;
    const root = error.roots.map(errorName).find((name) => roots.has(name));
    if (root === undefined) alone.push({ error, below: [] });
    else roots.get(root).below.push(error);
  }
  const trees = [...roots.values(), ...alone];
  for (const { below } of trees) below.sort((a, b) => byUrgency({ error: a }, { error: b }));
  trees.sort(byUrgency);
  const heard = trees.filter(({ error }) => !isSilenced(error));
  return {
    on: heard.filter(({ error, below }) => [error, ...below].some(isOn)),
    returned: heard.filter(({ error, below }) => ![error, ...below].some(isOn)),
    silenced: trees.filter(({ error }) => isSilenced(error)),
  };
}

/** The first of what follows from an error that is worse than the error itself; undefined: none is.
 *
 * `below` is sorted by urgency.
 */
export function worseBelow(error, below) {
  return below.find((each) => isOn(each) && rank(each) < rank(error));
}

function rank({ severity }) {
  return SEVERITIES.indexOf(severity);
}

/** A root is as urgent as the worst that follows from it. */
function byUrgency({ error: a, below: ofA = [] }, { error: b, below: ofB = [] }) {
  return (
    URGENCY[a.state] - URGENCY[b.state] ||
    rank(worseBelow(a, ofA) ?? a) - rank(worseBelow(b, ofB) ?? b) ||
    (a.since_at ?? "").localeCompare(b.since_at ?? "") ||
    errorName(a).localeCompare(errorName(b))
  );
}

/** Whether an acknowledgement may let the robot go on, now or when the cause ends. */
export function mayGoOn(error) {
  return error.state === "latched" || (error.state === "active" && isGrave(error));
}
