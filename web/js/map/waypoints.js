/** The waypoints of a path, as dots and with their numbers where they do not crowd. */

import { overlap } from "/web/js/map/bounds.js";
import { text } from "/web/js/map/grid.js";
import { seen, toScreen } from "/web/js/map/view.js";

const DOTS_APART_PX = 9;
const NUMBERS_APART_PX = 56;
const RADIUS_PX = 2.5;

/** Dots of the pieces that are seen; up to `doneSegment` they are filled. */
export function drawDots(context, view, ink, path, doneSegment) {
  if (path.spacing_m * view.scale < DOTS_APART_PX) return;
  context.lineWidth = 1.5;
  context.setLineDash([]);
  context.strokeStyle = ink.ahead;
  for (const position of positions(view, path)) {
    const { x, y } = toScreen(view, path.items[position]);
    context.fillStyle = position <= doneSegment ? ink.ahead : ink.ground;
    context.beginPath();
    context.arc(x, y, RADIUS_PX, 0, 2 * Math.PI);
    context.fill();
    context.stroke();
  }
}

/** Every waypoint, every second, fifth, tenth ... has its number, counted from 1. */
export function drawNumbers(context, view, ink, path) {
  const apart_px = path.spacing_m * view.scale;
  if (apart_px < DOTS_APART_PX) return;
  const every = roundUp(NUMBERS_APART_PX / apart_px);
  for (const position of positions(view, path)) {
    const number = path.indices[position] + 1;
    // The ends have words of their own.
    const isEnd = position === 0 || position === path.items.length - 1;
    if (number % every !== 0 || isEnd) continue;
    const { x, y } = toScreen(view, path.items[position]);
    text(context, ink, String(number), x + 6, y - 6, "left");
  }
}

function* positions(view, { pieces, items }) {
  const bounds = seen(view);
  for (const { first, last, bounds: box } of pieces) {
    if (!overlap(box, bounds)) continue;
    // The last item of a piece is the first of the next.
    const end = last === items.length - 1 ? last : last - 1;
    for (let position = first; position <= end; position += 1) yield position;
  }
}

/** The smallest of 1, 2, 5, 10, 20 ... that is at least `least`. */
function roundUp(least) {
  const power = 10 ** Math.floor(Math.log10(Math.max(1, least)));
  return [1, 2, 5, 10].find((factor) => factor * power >= least) * power;
}
