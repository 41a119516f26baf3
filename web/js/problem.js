/** Describes a rejected request, for any element that sends requests. */

import { el } from "/web/js/dom.js";

/** The problem as nodes; blockers that the detail already names are not repeated. */
export function problemLines({ title, detail, hint, blockers = [] }) {
  const said = detail ?? title;
  const more = blockers
    .map((blocker) => blocker.message)
    .filter((message) => !said.includes(message));
  return [
    el("strong", {}, "Rejected: "),
    el("span", {}, said),
    ...more.map((message) => el("p", {}, message)),
    hint ? el("p", { class: "hint" }, `Hint: ${hint}`) : null,
  ].filter((line) => line !== null);
}
