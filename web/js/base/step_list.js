/** The steps of a change or of a plan, by stage; those that take parts back come last. */

import { el } from "/web/js/base/dom.js";
import { duration } from "/web/js/base/words.js";

const MARKS = { pending: "·", running: "…", succeeded: "✓", failed: "✕", timed_out: "✕" };

/** The number of stages; nodes of one stage may run side by side. */
export function stageCount(steps) {
  return Math.max(0, ...forward(steps).map(({ stage }) => stage + 1));
}

/** "2 of 6 steps, stage 1 of 3"; empty without steps. A stage has begun up to `stage`. */
export function progressWords({ steps, stage }) {
  const way = forward(steps);
  if (way.length === 0) return "";
  const done = way.filter(({ status }) => status === "succeeded").length;
  const stages = stageCount(steps);
  const counted = `${done} of ${way.length} ${way.length === 1 ? "step" : "steps"}`;
  return stages > 1 ? `${counted}, stage ${Math.min(stage + 1, stages)} of ${stages}` : counted;
}

/** The lists of steps, each with a heading if there is more than one. */
export function stepLists(steps, now) {
  const way = forward(steps);
  const back = steps.filter(({ rollback }) => rollback);
  const stages = [];
  for (const step of way) (stages[step.stage] ??= []).push(step);
  const lists = stages.map((items, stage) => [`Stage ${stage + 1}`, items]).filter(Boolean);
  if (back.length) lists.push(["Going back", back]);
  return lists.flatMap(([title, items]) => [
    lists.length > 1 ? el("h4", {}, title) : null,
    el("ol", {}, ...items.map((step, index) => line(step, items[index - 1], now))),
  ]).filter((node) => node !== null);
}

function forward(steps) {
  return steps.filter(({ rollback }) => !rollback);
}

function line(step, before, now) {
  const { node, action, status, error, after } = step;
  // Said once, of the first step of each node.
  const isWaiting = status === "pending" && after.length > 0 && before?.node !== node;
  const waits = isWaiting ? `after ${after.join(", ")}` : null;
  return el(
    "li",
    { "data-status": status },
    el("span", { class: "step-mark", "aria-hidden": "true" }, MARKS[status] ?? "–"),
    el("span", {}, `${node}: ${action.replaceAll("_", " ")}`),
    el("span", { class: "quiet" }, timeWords(step, now)),
    waits ? el("span", { class: "facts" }, waits) : null,
    error ? el("span", { class: "step-error" }, error) : null,
  );
}

function timeWords({ status, started_at, ended_at, expected_s }, now) {
  const said = status.replaceAll("_", " ");
  if (!started_at) {
    const expected = status === "pending" && expected_s !== null;
    return expected ? `about ${duration(expected_s * 1000)}` : said;
  }
  return `${said}, ${duration((ended_at ? Date.parse(ended_at) : now) - Date.parse(started_at))}`;
}
