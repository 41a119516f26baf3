/** The steps of a change or of a plan, by stage; those that take parts back come last. */

import { el } from "/web/js/base/dom.js";
import { duration } from "/web/js/base/words.js";

/** A person reads so many steps; of more than these, only what is notable. */
const MANY = 24;
const NOTABLE = 12;
const AT_ONCE_S = 0.05;
const RUNNING = 3;
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

/** What is to be read of many steps: what failed, some that run, and how many each stage has. */
export function notableSteps(steps, now) {
  const failed = steps.filter(hasFailed);
  const running = steps.filter(({ status }) => status === "running");
  const shown = [...failed.slice(0, NOTABLE), ...running.slice(0, RUNNING)];
  const left = failed.length - NOTABLE;
  return [
    shown.length ? el("ol", {}, ...shown.map((step) => line(step, undefined, now))) : null,
    left > 0 ? el("p", { class: "step-error" }, `and ${left} more failed`) : null,
    el("ul", { class: "facts" }, ...stagesOf(steps).map(([title, items]) => el("li", {}, stageWords(title, items)))),
  ].filter((node) => node !== null);
}

/** Whether there are more steps than somebody would read one by one. */
export function areMany({ length }) {
  return length > MANY;
}

function hasFailed({ status }) {
  return status === "failed" || status === "timed_out";
}

/** "Stage 2: 3 of 400 steps". */
function stageWords(title, items) {
  const done = items.filter(({ status }) => status === "succeeded").length;
  return `${title}: ${done ? `${done} of ` : ""}${items.length} ${items.length === 1 ? "step" : "steps"}`;
}

/** The lists of steps, each with a heading if there is more than one. */
export function stepLists(steps, now) {
  const lists = stagesOf(steps);
  return lists.flatMap(([title, items]) => [
    lists.length > 1 ? el("h4", {}, title) : null,
    el("ol", {}, ...items.map((step, index) => line(step, items[index - 1], now))),
  ]).filter((node) => node !== null);
}

/** Stages as `[title, steps]`; what takes parts back comes last. */
function stagesOf(steps) {
  const way = forward(steps);
  const back = steps.filter(({ rollback }) => rollback);
  const stages = [];
  for (const step of way) (stages[step.stage] ??= []).push(step);
  const lists = stages.map((items, stage) => [`Stage ${stage + 1}`, items]).filter(Boolean);
  if (back.length) lists.push(["Going back", back]);
  return lists;
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
    if (!expected) return said;
    return expected_s < AT_ONCE_S ? "at once" : `about ${duration(expected_s * 1000)}`;
  }
  return `${said}, ${duration((ended_at ? Date.parse(ended_at) : now) - Date.parse(started_at))}`;
}
