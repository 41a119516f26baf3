/** Draws lanes on a canvas. */

import { ticksOf, xOf } from "/web/js/timeline/marks.js";

export const LANE_PX = 17;
export const ROW_PX = 14;
export const AXIS_PX = 16;
export const PAD_PX = 2;
const HATCH_PX = 6;
const TEXT_PX = 5;
const DAY_MS = 86_400_000;

/** Names of the colours that a canvas needs, as they are called in the style sheet. */
export const INKS = {
  ground: "surface",
  line: "line",
  grid: "map-grid",
  text: "text",
  quiet: "quiet",
  hatch: "edge",
  accent: "accent",
  rest: "lane-rest",
  active: "lane-active",
  busy: "lane-busy",
  command: "quiet",
  warn: "lane-warn",
  alarm: "lane-alarm",
  rejected: "lane-alarm",
  on: "lane-on",
};
const TEXT_ON = { alarm: "on", warn: "on" };

/** Draw all. `rows` are `{y, height, lane, rows: [marks]}`, in CSS px below the axis.
 *
 * @param scene `{rows, dark, scale, height, top, pinned, isPending, cursor}`; `top` is how far the
 *   lanes are scrolled, in px; `pinned` and `cursor` are times in ms, or null.
 */
export function drawTimeline(context, ink, ratio, scene) {
  const { scale, height } = scene;
  context.setTransform(ratio, 0, 0, ratio, 0, 0);
  context.fillStyle = ink.ground;
  context.fillRect(0, 0, scale.width, height);
  context.font = ink.font;
  context.textBaseline = "middle";
  const axis = ticksOf(scale);
  drawGrid(context, ink, scene, axis);
  for (const row of scene.rows) drawLane(context, ink, scene, row);
  for (const gap of scene.dark) hatch(context, ink, scale, gap, AXIS_PX, height - AXIS_PX);
  drawAxis(context, ink, scene, axis);
  drawRestarts(context, ink, scene);
  if (scene.cursor !== null) line(context, ink.quiet, xOf(scale, scene.cursor), scene, [3, 3]);
  if (scene.pinned !== null) drawPin(context, ink, scene);
}

function drawGrid(context, ink, { scale, height }, { ticks }) {
  context.fillStyle = ink.grid;
  for (const at of ticks) context.fillRect(Math.round(xOf(scale, at)), AXIS_PX, 1, height);
}

/** The axis stays in view where the lanes are scrolled. */
function drawAxis(context, ink, { scale, top }, { ticks, step }) {
  context.fillStyle = ink.ground;
  context.fillRect(0, top, scale.width, AXIS_PX);
  context.fillStyle = ink.line;
  context.fillRect(0, top + AXIS_PX - 1, scale.width, 1);
  context.textAlign = "left";
  for (const at of ticks) {
    const x = Math.round(xOf(scale, at));
    context.fillStyle = ink.line;
    context.fillRect(x, top + AXIS_PX - 6, 1, 6);
    context.fillStyle = ink.quiet;
    const words = tickWords(at, step);
    const isWithin = x + 3 + widthOf(context, words) < scale.width;
    if (isWithin) context.fillText(words, x + 3, top + AXIS_PX / 2);
  }
}

/** Midnight tells the date. */
function tickWords(at, step) {
  const date = new Date(at);
  const isMidnight = date.getHours() + date.getMinutes() + date.getSeconds() === 0;
  if (isMidnight && step < DAY_MS) return date.toLocaleDateString("en-GB", { day: "numeric", month: "short" });
  return date.toLocaleTimeString("en-GB").slice(0, step < 60_000 ? 8 : 5);
}

function drawLane(context, ink, { scale }, { y, height, lane, rows, isChosen }) {
  if (isChosen) {
    context.fillStyle = ink.accent;
    context.fillRect(0, y, 2, height);
  }
  context.fillStyle = ink.line;
  context.fillRect(0, y + height - 1, scale.width, 1);
  for (const gap of lane.unknown) hatch(context, ink, scale, gap, y + PAD_PX, height - 2 * PAD_PX);
  const isTicks = lane.key === "commands";
  rows.forEach((marks, n) => {
    const top = y + PAD_PX + n * ROW_PX;
    for (const mark of marks) drawMark(context, ink, mark, top, isTicks);
  });
}

function drawMark(context, ink, mark, top, isTicks) {
  const width = mark.x1 - mark.x0;
  const height = ROW_PX - 1;
  if (mark.tone === "unknown") {
    hatchAt(context, ink, mark.x0, width, top, height);
    return;
  }
  context.fillStyle = ink[mark.tone] ?? ink.rest;
  if (isTicks) {
    // A rejected command is low and red, so that not the colour alone tells it.
    const isLow = mark.tone === "rejected";
    context.fillRect(mark.x0, top + (isLow ? height / 2 : 0), width, isLow ? height / 2 : height);
  } else {
    // A gap of a pixel keeps equal neighbours apart; what is narrow needs all it has.
    context.fillRect(mark.x0, top, width > 4 ? width - 1 : width, height);
  }
  if (isTicks) return;
  const [{ short, text }] = mark.items;
  if (mark.items.length > 1) drawCount(context, ink, mark, top);
  else drawText(context, ink, mark, top, short ?? text);
}

/** Many changes in too few pixels: their number, as far as there is room. */
function drawCount(context, ink, mark, top) {
  const text = `×${mark.items.length}`;
  context.fillStyle = ink.ground;
  for (let x = mark.x0 + 2; x < mark.x1; x += 4) context.fillRect(x, top, 1, 3);
  drawText(context, ink, mark, top + 1, text);
}

function drawText(context, ink, { x0, x1, tone }, top, text) {
  const room = x1 - x0 - 2 * TEXT_PX;
  if (room < 12) return;
  const fitted = fit(context, text, room);
  if (!fitted) return;
  context.textAlign = "left";
  context.fillStyle = ink[TEXT_ON[tone] ?? "text"];
  context.fillText(fitted, x0 + TEXT_PX, top + ROW_PX / 2);
}

const widths = new Map();

/** The text if there is room for it, or as much as there is room for. */
function fit(context, text, room) {
  if (widthOf(context, text) <= room) return text;
  const length = Math.floor((text.length * room) / widthOf(context, text)) - 1;
  return length >= 3 ? `${text.slice(0, length)}…` : "";
}

function widthOf(context, text) {
  if (widths.size > 500) widths.clear();
  const key = context.font + text;
  if (!widths.has(key)) widths.set(key, context.measureText(text).width);
  return widths.get(key);
}

function drawRestarts(context, ink, { dark, scale, height, top }) {
  for (const { end, isRestart } of dark) {
    if (!isRestart || end < scale.from || end > scale.to) continue;
    const x = Math.round(xOf(scale, end));
    context.fillStyle = ink.text;
    context.fillRect(x, AXIS_PX, 1, height);
    context.beginPath();
    context.moveTo(x - 4, top + AXIS_PX);
    context.lineTo(x + 5, top + AXIS_PX);
    context.lineTo(x + 0.5, top + AXIS_PX + 6);
    context.fill();
  }
}

function drawPin(context, ink, { pinned, isPending, scale, height, top }) {
  const x = Math.round(xOf(scale, pinned));
  if (x < 0 || x > scale.width) return;
  context.fillStyle = ink.accent;
  context.setLineDash([]);
  if (isPending) for (let y = 0; y < height; y += 6) context.fillRect(x - 1, y, 2, 3);
  else context.fillRect(x - 1, 0, 2, height);
  context.beginPath();
  context.moveTo(x - 6, top);
  context.lineTo(x + 6, top);
  context.lineTo(x, top + 8);
  context.fill();
}

function line(context, colour, x, { height }, dash) {
  context.strokeStyle = colour;
  context.setLineDash(dash);
  context.beginPath();
  context.moveTo(Math.round(x) + 0.5, AXIS_PX);
  context.lineTo(Math.round(x) + 0.5, height);
  context.stroke();
  context.setLineDash([]);
}

function hatch(context, ink, scale, { begin, end }, top, height) {
  const x0 = Math.max(0, Math.round(xOf(scale, Math.max(begin, scale.from))));
  const x1 = Math.min(scale.width, Math.max(Math.round(xOf(scale, Math.min(end, scale.to))), x0 + 2));
  if (end >= scale.from && begin <= scale.to && x1 > x0)
    hatchAt(context, ink, x0, x1 - x0, top, height);
}

/** Oblique lines, which stay where they are when the timeline moves by less than one of them. */
function hatchAt(context, ink, x0, width, top, height) {
  context.save();
  context.beginPath();
  context.rect(x0, top, width, height);
  context.clip();
  context.fillStyle = ink.ground;
  context.fillRect(x0, top, width, height);
  context.strokeStyle = ink.hatch;
  context.globalAlpha = 0.55;
  context.lineWidth = 1;
  context.beginPath();
  for (let x = x0 - height; x < x0 + width; x += HATCH_PX) {
    context.moveTo(x, top + height);
    context.lineTo(x + height, top);
  }
  context.stroke();
  context.restore();
}
