/** The name beside a lane; that of a part selects it, and it can be kept. */

import { el } from "/web/js/base/dom.js";

const LONGEST = 14;

/** Return the row. `part` is the name of the part, or null; `keep` is called when that is toggled. */
export function laneName(lane, height, { part, canKeep, isKept, keep }) {
  const row = el("li", {});
  row.style.height = `${height}px`;
  if (part === null) {
    row.append(el("span", { class: "lane-name" }, lane.name));
    return row;
  }
  const select = () => row.dispatchEvent(new CustomEvent("ph-select", { bubbles: true, detail: part }));
  row.append(
    el("button", { type: "button", class: "lane-name", title: `Select ${part}`, onclick: select }, shortened(part)),
  );
  if (canKeep) {
    const name = isKept ? `Take the lane of ${part} away` : `Keep the lane of ${part}`;
    const props = { type: "button", class: "keep", title: name, "aria-label": name, onclick: keep };
    row.append(el("button", { ...props, "aria-pressed": String(isKept) }, isKept ? "×" : "+"));
  }
  return row;
}

/** Names of a robot often differ at their end: what is left out is in the middle. */
function shortened(name) {
  if (name.length <= LONGEST) return name;
  const half = Math.floor((LONGEST - 1) / 2);
  return `${name.slice(0, LONGEST - 1 - half)}…${name.slice(-half)}`;
}
