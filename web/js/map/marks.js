/** What the vehicle steers for: the target waypoint, and the point that its controller aims at. */

import { text } from "/web/js/map/grid.js";
import { toScreen } from "/web/js/map/view.js";

// So far from the vehicle the number of the target stands clear of it, px.
const CLEAR_PX = 34;
// So small that the mark would hide the vehicle, px per wheelbase.
const LEAST_WHEELBASE_PX = 14;
const DIAMOND_PX = 5;

/** `target` is `{place, index}`; its number, counted from 1, is said where there is room. */
export function drawTarget(context, view, ink, { place, index }, pose) {
  const { x, y } = toScreen(view, place);
  disc(context, x, y, 6, ink.ground);
  context.lineWidth = 2;
  context.strokeStyle = ink.accent;
  context.stroke();
  disc(context, x, y, 2.5, ink.accent);
  const vehicle = pose ? toScreen(view, pose) : null;
  if (vehicle && Math.hypot(vehicle.x - x, vehicle.y - y) < CLEAR_PX) return;
  text(context, { ...ink, quiet: ink.accent }, String(index + 1), x, y - 11, "center");
}

/** Pure Pursuit aims from the rear axle, Stanley corrects the error of the front axle. */
export function drawAim(context, view, ink, { pose, lookahead, limits }, controller) {
  if (limits.wheelbase_m * view.scale < LEAST_WHEELBASE_PX) return;
  const axle = controller === "stanley" ? frontAxle(pose, limits.wheelbase_m) : pose;
  const [from, to] = [toScreen(view, axle), toScreen(view, lookahead)];
  context.lineWidth = 1.5;
  context.strokeStyle = ink.aim;
  context.setLineDash([]);
  context.beginPath();
  context.moveTo(from.x, from.y);
  context.lineTo(to.x, to.y);
  context.stroke();
  context.fillStyle = ink.aim;
  context.beginPath();
  context.moveTo(to.x, to.y - DIAMOND_PX);
  context.lineTo(to.x + DIAMOND_PX, to.y);
  context.lineTo(to.x, to.y + DIAMOND_PX);
  context.lineTo(to.x - DIAMOND_PX, to.y);
  context.fill();
}

function frontAxle({ x_m, y_m, yaw_rad }, wheelbase_m) {
  const [x, y] = [Math.cos(yaw_rad), Math.sin(yaw_rad)];
  return { x_m: x_m + wheelbase_m * x, y_m: y_m + wheelbase_m * y };
}

function disc(context, x, y, radius, colour) {
  context.fillStyle = colour;
  context.setLineDash([]);
  context.beginPath();
  context.arc(x, y, radius, 0, 2 * Math.PI);
  context.fill();
}
