/** Ground of the map: a grid in metres with its figures, and a scale bar. */

import { seen, toScreen } from "/web/js/map/view.js";

const LEAST_GAP_PX = 64;
const LONGEST_BAR_PX = 110;
const EDGE_PX = 6;
// Beside the name of the axis, so that no path that is fitted runs below it.
const BAR_AT_PX = [56, 27];

/** The largest of 1, 2, 5, 10, 20 ... that is at most `limit`. */
export function roundStep(limit) {
  const power = 10 ** Math.floor(Math.log10(limit));
  return [5, 2, 1].find((factor) => factor * power <= limit * (1 + 1e-9)) * power;
}

/** The smallest of 1, 2, 5, 10, 20 ... (m) that leaves lines far enough apart. */
function gridStep(scale) {
  const least = LEAST_GAP_PX / scale;
  const step = roundStep(least);
  return [step, roundStep(2 * step), roundStep(2.5 * step), roundStep(5 * step)].find(
    (candidate) => candidate >= least * (1 - 1e-9),
  );
}

export function drawGrid(context, view, ink) {
  const step = gridStep(view.scale);
  const { minX, minY, maxX, maxY } = seen(view);
  const across = [...multiples(minX, maxX, step)].map((x_m) => [
    x_m,
    toScreen(view, { x_m, y_m: 0 }).x,
  ]);
  const up = [...multiples(minY, maxY, step)].map((y_m) => [
    y_m,
    toScreen(view, { x_m: 0, y_m }).y,
  ]);
  context.lineWidth = 1;
  for (const [x_m, x] of across)
    line(context, x_m === 0 ? ink.axis : ink.grid, x, 0, x, view.height);
  for (const [y_m, y] of up) line(context, y_m === 0 ? ink.axis : ink.grid, 0, y, view.width, y);
  for (const [x_m, x] of across) {
    const clear = x > 48 && x < view.width - 48;
    if (clear) text(context, ink, figure(x_m, step), x, view.height - EDGE_PX, "center");
  }
  for (const [y_m, y] of up) {
    const clear = y > 26 && y < view.height - 26;
    if (clear) text(context, ink, figure(y_m, step), EDGE_PX, y + 4, "left");
  }
  text(context, ink, "y (m)", EDGE_PX, EDGE_PX + 10, "left");
  text(context, ink, "x (m)", view.width - EDGE_PX, view.height - EDGE_PX, "right");
}

export function drawScaleBar(context, view, ink) {
  const length = roundStep(LONGEST_BAR_PX / view.scale);
  const [left, y] = BAR_AT_PX;
  const right = left + length * view.scale;
  context.strokeStyle = ink.text;
  context.lineWidth = 1.5;
  context.beginPath();
  context.moveTo(left, y - 5);
  context.lineTo(left, y);
  context.lineTo(right, y);
  context.lineTo(right, y - 5);
  context.stroke();
  const words = length >= 1000 ? `${length / 1000} km` : `${figure(length, length)} m`;
  text(context, { ...ink, quiet: ink.text }, words, (left + right) / 2, y - 6, "center");
}

function* multiples(from, to, step) {
  for (let count = Math.ceil(from / step); count * step <= to; count += 1) yield count * step;
}

function figure(value, step) {
  const digits = Math.max(0, -Math.floor(Math.log10(step) + 1e-9));
  return value.toFixed(digits).replace("-", "−");
}

/** Half a pixel off, so that a line of one pixel does not smear over two. */
function line(context, colour, x1, y1, x2, y2) {
  context.strokeStyle = colour;
  context.beginPath();
  context.moveTo(Math.round(x1) + 0.5, Math.round(y1) + 0.5);
  context.lineTo(Math.round(x2) + 0.5, Math.round(y2) + 0.5);
  context.stroke();
}

/** Write with an edge of the ground's colour, so that lines beneath do not cross the letters. */
export function text(context, ink, words, x, y, align) {
  context.font = ink.font;
  context.textAlign = align;
  context.lineJoin = "round";
  context.lineWidth = 4;
  context.strokeStyle = ink.ground;
  context.strokeText(words, x, y);
  context.fillStyle = ink.quiet;
  context.fillText(words, x, y);
}
