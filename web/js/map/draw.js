/** Draws a scene: path done and ahead, trail, target, look-ahead point and vehicle.
 *
 * A scene is `{path, split, target, preview, runs, vehicle, isOld}`; whatever is null is left out.
 */

import { overlap } from "/web/js/map/bounds.js";
import { drawGrid, drawScaleBar, text } from "/web/js/map/grid.js";
import { lengthOf } from "/web/js/map/path_shape.js";
import { drawVehicle } from "/web/js/map/vehicle.js";
import { seen, toScreen } from "/web/js/map/view.js";

// Told apart by their dashes too, not by colour alone; px.
const TRAIL = {
  RUNNING: { ink: "trail", dash: [] },
  ERROR: { ink: "alarm", dash: [6, 4] },
  IDLE: { ink: "quiet", dash: [1.5, 3.5] },
};
const AHEAD = { width: 2, dash: [7, 5] };

export function drawScene(context, view, ink, ratio, scene) {
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = ink.ground;
  context.fillRect(0, 0, view.width, view.height);
  drawGrid(context, view, ink);
  if (scene.path) drawPath(context, view, ink, ratio, scene);
  if (scene.preview) drawPreview(context, view, ink, ratio, scene.preview);
  drawTrail(context, view, ink, ratio, scene.runs);
  const marked = scene.preview ?? scene.path;
  if (marked) drawEnds(context, view, ink, marked);
  if (scene.target) drawTarget(context, view, ink, scene.target);
  if (scene.vehicle?.pose) {
    if (scene.vehicle.lookahead) drawLookahead(context, view, ink, scene.vehicle);
    drawVehicle(context, view, ink, scene.vehicle, scene.isOld);
  }
  drawScaleBar(context, view, ink);
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

function drawPath(context, view, ink, ratio, { path, split, preview }) {
  const bounds = seen(view);
  const visible = path.pieces.filter((piece) => overlap(piece.bounds, bounds));
  inMetres(context, view, ratio, path.origin, (px) => {
    const done = (shape) => stroke(context, shape, ink.done, 6 * px, []);
    const ahead = (shape, before_m) => {
      const colour = preview ? ink.axis : ink.ahead;
      stroke(context, shape, colour, AHEAD.width * px, scaled(AHEAD.dash, px), before_m);
    };
    for (const { first, last, before_m, shape } of visible) {
      if (last <= split.segment) done(shape);
      else if (first > split.segment) ahead(shape, before_m);
      else {
        const begin = [...path.items.slice(first, split.segment + 1), split.place];
        const rest = [split.place, ...path.items.slice(split.segment + 1, last + 1)];
        ahead(path.shapeOf(rest), before_m + lengthOf(begin));
        done(path.shapeOf(begin));
      }
    }
  });
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

function drawTrail(context, view, ink, ratio, runs) {
  const bounds = seen(view);
  for (const run of runs) {
    if (!overlap(run.bounds, bounds)) continue;
    const look = TRAIL[run.state] ?? TRAIL.IDLE;
    inMetres(context, view, ratio, run.origin, (px) =>
      stroke(context, run.shape, ink[look.ink], 2 * px, scaled(look.dash, px)),
    );
  }
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

function drawTarget(context, view, ink, target) {
  const { x, y } = toScreen(view, target);
  context.lineWidth = 2;
  context.strokeStyle = ink.accent;
  context.fillStyle = ink.ground;
  context.beginPath();
  context.arc(x, y, 6, 0, 2 * Math.PI);
  context.fill();
  context.stroke();
  context.fillStyle = ink.accent;
  context.beginPath();
  context.arc(x, y, 2.5, 0, 2 * Math.PI);
  context.fill();
}

function drawLookahead(context, view, ink, { pose, lookahead }) {
  const [from, to] = [toScreen(view, pose), toScreen(view, lookahead)];
  context.lineWidth = 1.5;
  context.strokeStyle = ink.aim;
  context.beginPath();
  context.moveTo(from.x, from.y);
  context.lineTo(to.x, to.y);
  context.stroke();
  context.fillStyle = ink.aim;
  context.beginPath();
  context.moveTo(to.x, to.y - 6);
  context.lineTo(to.x + 6, to.y);
  context.lineTo(to.x, to.y + 6);
  context.lineTo(to.x - 6, to.y);
  context.fill();
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
