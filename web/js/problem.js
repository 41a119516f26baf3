/** Words on a refusal, for any element that asked for something. */

import { el } from "/web/js/dom.js";

/** The refusal as nodes; blockers that the detail already names are not said twice. */
export function problemLines({ title, detail, hint, blockers = [] }) {
  const said = detail ?? title;
  const more = blockers
    .map((blocker) => blocker.message)
    .filter((message) => !said.includes(message));
  return [
    el("strong", {}, "Refused: "),
    el("span", {}, said),
    ...more.map((message) => el("p", {}, message)),
    hint ? el("p", { class: "hint" }, `Hint: ${hint}`) : null,
  ].filter((line) => line !== null);
}
