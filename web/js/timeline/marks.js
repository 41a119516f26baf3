/** Intervals on a scale of pixels, without losing one: pure functions.
 *
 * A scale is `{from, to, width}`, in ms and CSS px.
 */

/** What is narrower could not be seen, px. */
export const MIN_PX = 2;
/** From calm to urgent: what a mark of several intervals is drawn as. */
const URGENCY = ["rest", "active", "busy", "command", "unknown", "warn", "rejected", "alarm"];
const STEPS_S = [1, 5, 10, 30, 60, 120, 300, 600, 1800, 3600, 7200, 10_800, 21_600, 43_200];
const LABEL_PX = 64;

/** Where a time is on a scale, px. */
export function xOf({ from, to, width }, at) {
  return ((at - from) / (to - from)) * width;
}

/** The time at a place, ms. */
export function timeAt({ from, to, width }, x) {
  return from + (x / width) * (to - from);
}

/** Put intervals that overlap into rows below each other, at most `most`; the last takes the rest. */
export function rowsOf(intervals, most) {
  const rows = [];
  const ends = [];
  for (const interval of intervals) {
    let row = ends.findIndex((end) => end <= interval.begin);
    if (row < 0) row = Math.min(ends.length, most - 1);
    (rows[row] ??= []).push(interval);
    ends[row] = Math.max(ends[row] ?? -Infinity, interval.end);
  }
  return rows.length ? rows : [[]];
}

/** The marks of one row: `{x0, x1, tone, items}`; what would be narrower than two pixels, or hidden
 * by the one before, shares its mark.
 *
 * @param intervals In the order of their begins.
 */
export function marksOf(intervals, scale) {
  const marks = [];
  for (const interval of intervals) {
    if (interval.tone === "none" || interval.end < scale.from || interval.begin > scale.to) continue;
    const end = Math.min(interval.end, scale.to);
    const left = Math.max(0, Math.round(xOf(scale, interval.begin)));
    const right = Math.max(Math.round(xOf(scale, end)), left + MIN_PX);
    const last = marks.at(-1);
    const x0 = Math.max(left, last?.x1 ?? 0);
    // Neighbours may be a mark's width too near; what overlaps by more is not one after the other.
    const isHidden = last && (right - x0 < MIN_PX || last.x1 - left > MIN_PX);
    if (isHidden) join(last, interval, right);
    else marks.push({ x0, x1: right, tone: interval.tone, items: [interval] });
  }
  return marks;
}

function join(mark, interval, right) {
  mark.items.push(interval);
  mark.x1 = Math.max(mark.x1, right);
  if (urgency(interval) > urgency(mark)) mark.tone = interval.tone;
}

function urgency({ tone }) {
  return URGENCY.indexOf(tone);
}

/** Round times that are far enough apart for a label each, in local time; the step is in ms. */
export function ticksOf({ from, to, width }) {
  const least = ((to - from) / width) * LABEL_PX;
  const step = 1000 * (STEPS_S.find((seconds) => seconds * 1000 >= least) ?? 86_400);
  const shift = new Date(to).getTimezoneOffset() * 60_000;
  const ticks = [];
  for (let at = Math.ceil((from - shift) / step) * step + shift; at <= to; at += step)
    ticks.push(at);
  return { ticks, step };
}

/** All times at which something begins or ends, in order. */
export function edgesOf(lanes) {
  const times = new Set();
  for (const { intervals } of lanes)
    for (const { begin, end, cut, lost, tone } of intervals) {
      if (!cut && tone !== "none") times.add(begin);
      if (!lost && end !== Infinity && tone !== "none") times.add(end);
    }
  return [...times].sort((a, b) => a - b);
}
