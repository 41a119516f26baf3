/** The vehicle as seen from above, true to scale; as a symbol where that would be too small. */

import { toScreen } from "/web/js/map/view.js";

// Outline of the Polaris GEM e2 around the middle of its rear axle, m.
const [BACK, FRONT, HALF_WIDTH] = [-0.35, 2.1, 0.85];
const MIDDLE = (BACK + FRONT) / 2;
const [WHEEL_LENGTH, WHEEL_WIDTH, HALF_TRACK] = [0.56, 0.2, 0.68];
const SYMBOL_PX = 22;
const LEAST_OUTLINE_PX = 18;
const HEADING_PX = 14;

/** Draw the vehicle; hollow where its pose is old. */
export function drawVehicle(context, view, ink, { pose, steering_angle_rad, limits }, isOld) {
  const { x, y } = toScreen(view, pose);
  const isSmall = (FRONT - BACK) * view.scale < LEAST_OUTLINE_PX;
  context.save();
  context.translate(x, y);
  context.rotate(-pose.yaw_rad);
  const fill = isOld ? ink.ground : ink.vehicle;
  if (isSmall) drawSymbol(context, view, ink, fill);
  else drawOutline(context, view, ink, fill, steering_angle_rad ?? 0, limits.wheelbase_m);
  context.restore();
}

function drawSymbol(context, view, ink, fill) {
  context.setLineDash([]);
  context.translate(MIDDLE * view.scale, 0);
  const half = SYMBOL_PX / 2;
  trace(context, [half, 0], [-half, -half * 0.75], [-half * 0.5, 0], [-half, half * 0.75]);
  paint(context, fill, ink.outline, 2);
}

/** A line ahead of the front tells the heading from afar. */
function drawHeading(context, ink, px) {
  context.beginPath();
  context.moveTo(FRONT, 0);
  context.lineTo(FRONT + HEADING_PX * px, 0);
  context.lineWidth = 2 * px;
  context.strokeStyle = ink.outline;
  context.stroke();
}

/** In metres, x to the front and y to the left; the rotation is done already. */
function drawOutline(context, view, ink, fill, steering, wheelbase) {
  context.scale(view.scale, -view.scale);
  const px = 1 / view.scale;
  context.setLineDash([]);
  drawHeading(context, ink, px);
  context.beginPath();
  context.roundRect(BACK, -HALF_WIDTH, FRONT - BACK, 2 * HALF_WIDTH, 0.3);
  context.globalAlpha = 0.85;
  paint(context, fill, ink.outline, 2 * px);
  context.globalAlpha = 1;
  // The windscreen tells front from back.
  trace(context, [0.95, -0.5], [1.3, -0.42], [1.3, 0.42], [0.95, 0.5]);
  paint(context, ink.ground, ink.outline, px);
  for (const side of [-1, 1]) {
    drawWheel(context, ink, 0, side * HALF_TRACK, 0);
    drawWheel(context, ink, wheelbase, side * HALF_TRACK, steering);
  }
}

function drawWheel(context, ink, x, y, angle) {
  context.save();
  context.translate(x, y);
  context.rotate(angle);
  context.fillStyle = ink.outline;
  context.fillRect(-WHEEL_LENGTH / 2, -WHEEL_WIDTH / 2, WHEEL_LENGTH, WHEEL_WIDTH);
  context.restore();
}

function trace(context, ...corners) {
  context.beginPath();
  for (const corner of corners) context.lineTo(...corner);
  context.closePath();
}

function paint(context, fill, line, width) {
  context.fillStyle = fill;
  context.fill();
  context.lineJoin = "round";
  context.lineWidth = width;
  context.strokeStyle = line;
  context.stroke();
}
