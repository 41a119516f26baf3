/** Texts on tasks, holds and the vehicle: pure functions. */

import { duration, timeOfDay } from "/web/js/base/words.js";

/** "Pure Pursuit" for pure_pursuit. */
export function controllerName(name) {
  return name.replace(/(^|_)([a-z])/g, (_, before, letter) => (before && " ") + letter.toUpperCase());
}

export const TASK_STATUS = {
  RUNNING: "Running",
  PAUSING: "Stopping",
  PAUSED: "Paused",
  SUCCEEDED: "Succeeded",
  CANCELED: "Canceled",
  ABORTED: "Aborted",
};

/** "412 m"; with a decimal below 10 m. */
export function metres(value) {
  return `${value.toFixed(Math.abs(value) < 10 ? 1 : 0)} m`;
}

/** Whole percent; 100 only at the end. */
export function percent(share) {
  return `${Math.floor(share * 100 + 1e-9)} %`;
}

/** "waypoint 41" for the index 40: the page counts from 1, as people do. */
export function waypointName(index) {
  return `waypoint ${index + 1}`;
}

/** "waypoint 41 of 66", counted from 1. */
export function waypointWords({ target_index, waypoint_count }) {
  return `${waypointName(Math.min(target_index, waypoint_count - 1))} of ${waypoint_count}`;
}

/** How a task ended. */
export function endWords({ id, status, reason, created_at, ended_at, distance_m, length_m }) {
  const took = duration(Date.parse(ended_at) - Date.parse(created_at));
  const way = `${metres(distance_m)} of ${metres(length_m)} in ${took}`;
  const how = TASK_STATUS[status].toLowerCase();
  const why = reason && reason !== how ? `: ${reason}` : "";
  return `Task ${id} ${how} at ${timeOfDay(ended_at)}${why} (${way})`;
}

/** "2.8 of 2.8 m/s, 0.03 m left of the path": actual and cruise speed, cross-track error. */
export function driveWords(task, vehicle) {
  const now = typeof vehicle?.speed_mps === "number" ? vehicle.speed_mps.toFixed(1) : "?";
  const speed = `${now} of ${task.speed_mps.toFixed(1)} m/s`.replace("-", "−");
  const error = task.cross_track_error_m;
  return typeof error === "number" ? `${speed}, ${besidePath(error)}` : speed;
}

/** "2.8 m/s"; with a second decimal below 1 m/s. */
export function speed(value_mps) {
  return `${value_mps.toFixed(Math.abs(value_mps) < 1 ? 2 : 1)} m/s`.replace("-", "−");
}

export function speedWords(speed_mps) {
  return typeof speed_mps === "number" ? speed(speed_mps) : "?";
}

/** "0.03 m left": on which side of the path the vehicle is. */
export function offPath(error_m) {
  if (typeof error_m !== "number") return "–";
  const far = Math.abs(error_m).toFixed(2);
  if (far === "0.00") return "0.00 m";
  return `${far} m ${error_m > 0 ? "left" : "right"}`;
}

function besidePath(error_m) {
  return Math.abs(error_m) < 0.005 ? "on the path" : `${offPath(error_m)} of the path`;
}

/** Since when there is no newer pose; empty for a current one, or for none.
 *
 * A vehicle at rest is in few frames, so the time of its pose says nothing: the service tells of a
 * pose that is too old by its hold `vehicle`.
 */
export function poseAge({ vehicle, holds }, contact) {
  if (!vehicle?.at || !vehicle.pose) return "";
  if (contact.level === "lost") return `pose of ${timeOfDay(vehicle.at)}`;
  return holds.vehicle ? `no pose since ${timeOfDay(holds.vehicle.since_at)}` : "";
}

/** The map in a sentence or two, for screen readers. */
export function mapSentence({ vehicle, task }, age) {
  const said = [];
  if (vehicle?.pose) {
    const { x_m, y_m, yaw_rad } = vehicle.pose;
    const place = `x ${x_m.toFixed(1)} m, y ${y_m.toFixed(1)} m`;
    const heading = `heading ${Math.round((yaw_rad * 180) / Math.PI)} degrees`;
    said.push(`Vehicle at ${place}, ${heading}, ${speedWords(vehicle.speed_mps)}.`);
  } else said.push("The pose of the vehicle is unknown.");
  if (age) said.push(`This is old: ${age}.`);
  if (task?.ended_at) said.push(`${endWords(task)}.`);
  else if (task) {
    const error = task.cross_track_error_m;
    const beside = typeof error === "number" ? `, ${besidePath(error)}` : "";
    said.push(`Task ${task.id}, ${percent(task.progress)} done, ${waypointWords(task)}${beside}.`);
  }
  return said.join(" ");
}

/** The area that the map shows. */
export function viewSentence({ x_m, y_m, scale, width, height }) {
  const size = `${metres(width / scale)} by ${metres(height / scale)}`;
  return `The map shows ${size} around x ${metres(x_m)}, y ${metres(y_m)}.`;
}

/** The lines of a preview. */
export function previewLines(preview, speed_mps) {
  const { waypoint_count, length_m, spacing, min_radius_m, vehicle_min_radius_m } = preview;
  const lines = [
    `${metres(length_m)}, ${waypoint_count} waypoints, ${spacing.median_m.toFixed(2)} m apart`,
  ];
  if (typeof preview.duration_s === "number")
    lines.push(`About ${duration(preview.duration_s * 1000)} at ${speed_mps} m/s`);
  const limit = `the vehicle needs ${metres(vehicle_min_radius_m)}`;
  lines.push(
    typeof min_radius_m === "number"
      ? `Tightest radius ${metres(min_radius_m)}; ${limit}`
      : "Straight path",
  );
  if (preview.start) {
    const turn = Math.round((Math.abs(preview.start.heading_error_rad) * 180) / Math.PI);
    lines.push(
      `Starts ${metres(preview.start.distance_m)} from the vehicle, ${turn}° off its heading`,
    );
  }
  if (preview.csv) lines.push(sentence(preview.csv.message));
  return lines;
}

function sentence(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}
