/** How severe an error is: a shape of its own for each severity, and what follows from it in words. */

import { renderOnce, setAttribute } from "/web/js/base/dom.js";

const SPACE = "http://www.w3.org/2000/svg";

/** A ring, a diamond, a triangle and an octagon: told apart without their colours. */
const SHAPES = {
  warning: "M8 2.5a5.5 5.5 0 1 0 .01 0z",
  urgent: "M8 1.5L14.5 8 8 14.5 1.5 8z",
  critical: "M8 1.5L15 14H1z",
  fatal: "M5.3 1.5h5.4l3.8 3.8v5.4l-3.8 3.8H5.3l-3.8-3.8V5.3z",
};

const CONSEQUENCES = {
  warning: "Warning: the robot goes on",
  urgent: "Urgent: it needs attention soon",
  critical: "Critical: the task cannot go on",
  fatal: "Fatal: the robot needs somebody's hands",
};

/** "Critical: the task cannot go on". */
export function consequence({ severity }) {
  return CONSEQUENCES[severity] ?? severity;
}

/** Show the shape of a severity in `node`; filled while the error is on. */
export function showShape(node, severity, isOn) {
  setAttribute(node, "data-on", isOn);
  renderOnce(node, severity, () => [shape(severity)]);
}

function shape(severity) {
  const svg = document.createElementNS(SPACE, "svg");
  svg.setAttribute("viewBox", "0 0 16 16");
  svg.setAttribute("aria-hidden", "true");
  const path = document.createElementNS(SPACE, "path");
  path.setAttribute("d", SHAPES[severity] ?? SHAPES.warning);
  svg.append(path);
  return svg;
}
