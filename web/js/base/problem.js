/** Describes a rejected request, for any element that sends requests. */

import { el, renderOnce, setAttribute } from "/web/js/base/dom.js";

/** What fields of requests are called on the page. */
const FIELDS = {
  speed_mps: "Speed",
  controller: "Controller",
  heading: "Headings",
  columns: "Columns",
  start_index: "Start",
};
/** Words of the interface that are of no use on the page. */
const OF_THE_API = /[?&]\w+=|\bstart_index\b|\b(GET|PUT|POST|PATCH|DELETE) |Content-Type|(^|\s|\x60)--?\w/;

/** The problem as nodes; blockers that the detail already names are not repeated. */
export function problemLines(problem) {
  const said = detailWords(problem);
  const hint = hintWords(problem);
  const more = (problem.blockers ?? [])
    .map((blocker) => blocker.message)
    .filter((message) => !said.includes(message));
  return [
    el("strong", {}, `${outcome(problem)}: `),
    el("span", {}, said),
    ...more.map((message) => el("p", {}, message)),
    hint ? el("p", { class: "hint" }, `Hint: ${hint}`) : null,
  ].filter((line) => line !== null);
}

/** Show a problem in `node`, or nothing for null. */
export function showProblem(node, problem) {
  setAttribute(node, "hidden", !problem);
  renderOnce(node, JSON.stringify(problem), () => (problem ? problemLines(problem) : []));
}

/** Only an answer that refuses says that nothing was done. */
function outcome({ status, code }) {
  if (status === 0) return "No answer";
  if (code === "STORAGE_DEGRADED") return "Rejected";
  if (status === 504) return "Outcome unknown";
  return status >= 500 ? "Failed" : "Rejected";
}

/** What went wrong, without the names that fields have in requests. */
export function detailWords({ detail, title }) {
  const said = detail ?? title;
  // A message about a member of a body is complete in itself.
  const plain = said.replace(/^(\/[\w/]+): /, "");
  return plain.replace(/^query (\w+): /, (_, name) => `${FIELDS[name] ?? name}: `);
}

/** The hint as one can follow it on the page; empty without one. */
export function hintWords({ hint }) {
  if (!hint) return "";
  if (hint.includes("?columns=")) {
    const [, example] = /\?columns=([\w,-]+)/.exec(hint) ?? [null, "x,y,yaw"];
    const heading = hint.includes("?heading=") ? ", or what its headings are in" : "";
    return `say above what the columns are, such as ${example}${heading}`;
  }
  if (hint.includes("?heading=")) return "choose above what the headings are in";
  return OF_THE_API.test(hint) ? "" : hint;
}
