/** Draws a scene: ground, path, trail, waypoints, target, look-ahead point and vehicle.
 *
 * A scene is `{path, split, target, preview, runs, vehicle, controller, isOld}`; whatever is null is
 * left out. What rests (`drawStill`) and what moves with the vehicle (`drawMoving`) are drawn apart,
 * so that the first can be kept: the path changes its look only in the piece that is driven now.
 */

import { overlap } from "/web/js/map/bounds.js";
import { drawGrid, drawScaleBar, text } from "/web/js/map/grid.js";
import { drawAim, drawTarget } from "/web/js/map/marks.js";
import { lengthOf } from "/web/js/map/path_shape.js";
import { drawVehicle } from "/web/js/map/vehicle.js";
import { seen, toScreen } from "/web/js/map/view.js";
import { drawDots, drawNumbers } from "/web/js/map/waypoints.js";

// Told apart by their dashes too, not by colour alone; px.
const TRAIL = {
  RUNNING: { ink: "trail", dash: [] },
  HELD: { ink: "warn", dash: [9, 3] },
  ERROR: { ink: "alarm", dash: [6, 4] },
  IDLE: { ink: "quiet", dash: [1.5, 3.5] },
};
const DONE_PX = 5;
const AHEAD = { width: 2, dash: [7, 5] };

/** Draw what rests while the vehicle drives on within a piece of the path. */
export function drawStill(context, view, ink, ratio, scene) {
  const { path, preview, runs, split } = scene;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = ink.ground;
  context.fillRect(0, 0, view.width, view.height);
  drawGrid(context, view, ink);
  if (path) drawPath(context, view, ink, ratio, scene);
  if (preview) drawPreview(context, view, ink, ratio, preview);
  for (const run of runs.slice(0, -1)) drawRun(context, view, ink, ratio, run);
  const marked = preview ?? path;
  if (marked) {
    drawDots(context, view, ink, marked, preview ? -1 : split.segment);
    drawNumbers(context, view, ink, marked);
    drawEnds(context, view, ink, marked);
  }
  drawScaleBar(context, view, ink);
}

/** Draw over that what changes with each report of the vehicle. */
export function drawMoving(context, view, ink, ratio, scene) {
  const { path, split, preview, runs, target, vehicle, isOld } = scene;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  const piece = path?.pieceOf(split.segment);
  if (piece) {
    drawDriven(context, view, ink, ratio, scene, piece);
    if (!preview) drawDots(context, view, ink, { ...path, pieces: [piece] }, split.segment);
  }
  if (runs.length > 0) drawRun(context, view, ink, ratio, runs.at(-1));
  if (target) drawTarget(context, view, ink, target, vehicle?.pose);
  if (!vehicle?.pose) return;
  drawVehicle(context, view, ink, vehicle, isOld);
  if (vehicle.lookahead) drawAim(context, view, ink, vehicle, scene.controller);
}

/** Count in metres from `origin` until `act` returns; lengths in px are divided by the scale. */
function inMetres(context, view, ratio, origin, act) {
  const { x, y } = toScreen(view, origin);
  const scale = ratio * view.scale;
  context.save();
  context.setTransform(scale, 0, 0, -scale, ratio * x, ratio * y);
  context.lineJoin = "round";
  act(1 / view.scale);
  context.restore();
}

/** The pieces that are wholly done or wholly ahead. */
function drawPath(context, view, ink, ratio, { path, split, preview }) {
  const bounds = seen(view);
  const visible = path.pieces.filter((piece) => overlap(piece.bounds, bounds));
  inMetres(context, view, ratio, path.origin, (px) => {
    for (const { first, last, before_m, shape } of visible) {
      if (last <= split.segment) strokeDone(context, ink, px, shape);
      else if (first > split.segment) strokeAhead(context, ink, px, shape, before_m, preview);
    }
  });
}

/** The piece that the vehicle is on, a part of it done and a part ahead. */
function drawDriven(context, view, ink, ratio, { path, split, preview }, { first, last, before_m }) {
  const done = [...path.items.slice(first, split.segment + 1), split.place];
  const ahead = [split.place, ...path.items.slice(split.segment + 1, last + 1)];
  inMetres(context, view, ratio, path.origin, (px) => {
    const from_m = before_m + lengthOf(done);
    strokeAhead(context, ink, px, path.shapeOf(ahead), from_m, preview);
    strokeDone(context, ink, px, path.shapeOf(done));
  });
}

function strokeDone(context, ink, px, shape) {
  stroke(context, shape, ink.done, DONE_PX * px, []);
}

function strokeAhead(context, ink, px, shape, from_m, preview) {
  const colour = preview ? ink.axis : ink.ahead;
  stroke(context, shape, colour, AHEAD.width * px, scaled(AHEAD.dash, px), from_m);
}

function drawPreview(context, view, ink, ratio, path) {
  const bounds = seen(view);
  inMetres(context, view, ratio, path.origin, (px) => {
    for (const { before_m, shape, bounds: box } of path.pieces) {
      if (!overlap(box, bounds)) continue;
      stroke(context, shape, ink.accent, 3 * px, scaled([10, 4, 2, 4], px), before_m);
    }
  });
}

function drawRun(context, view, ink, ratio, run) {
  if (!overlap(run.bounds, seen(view))) return;
  const look = TRAIL[run.state] ?? TRAIL.IDLE;
  inMetres(context, view, ratio, run.origin, (px) =>
    stroke(context, run.shape, ink[look.ink], 2 * px, scaled(look.dash, px)),
  );
}

function drawEnds(context, view, ink, { start, end }) {
  const [from, to] = [toScreen(view, start), toScreen(view, end)];
  context.lineWidth = 2;
  context.strokeStyle = ink.text;
  context.fillStyle = ink.ground;
  context.beginPath();
  context.arc(from.x, from.y, 5, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  context.fillStyle = ink.text;
  context.fillRect(to.x - 4.5, to.y - 4.5, 9, 9);
  // The words keep apart where a loop ends at its start.
  const below = from.y >= to.y;
  text(context, ink, "start", from.x, from.y + (below ? 20 : -11), "center");
  text(context, ink, "end", to.x, to.y + (below ? -11 : 20), "center");
}

function stroke(context, shape, colour, width, dash, offset = 0) {
  context.strokeStyle = colour;
  context.lineWidth = width;
  context.setLineDash(dash);
  context.lineDashOffset = offset;
  context.stroke(shape);
}

function scaled(dash, px) {
  return dash.map((length) => length * px);
}
