/** The shown stretch of time: `{span, end}` in ms; `end` null follows now. Pure functions. */

export const MINUTE = 60_000;
export const LONGEST = 24 * 60 * MINUTE;
export const SPANS = [
  [MINUTE, "1 min"],
  [10 * MINUTE, "10 min"],
  [60 * MINUTE, "1 h"],
  [360 * MINUTE, "6 h"],
  [LONGEST, "24 h"],
];
const SHORTEST = MINUTE / 6;

/** The begin and the end on a canvas of `width` px; while it follows now it moves by whole pixels. */
export function scaleOf({ span, end }, now, width) {
  const pixel = span / Math.max(1, width);
  const to = end ?? Math.ceil(now / pixel) * pixel;
  return { from: to - span, to, width };
}

/** Zoom about a place between 0 (begin) and 1 (end), which stays where it is. */
export function zoomed(range, factor, place, now) {
  const span = Math.min(LONGEST, Math.max(SHORTEST, range.span / factor));
  // Who looks at now goes on looking at now.
  if (range.end === null) return { span, end: null };
  return settled({ span, end: range.end + (span - range.span) * (1 - place) }, now);
}

/** Move by a time; at now it follows again. */
export function moved(range, by, now) {
  return settled({ span: range.span, end: (range.end ?? now) + by }, now);
}

/** Show a moment, in the middle if it is not in view. */
export function showing(range, at, now) {
  const end = range.end ?? now;
  if (at >= end - range.span && at <= end) return { span: range.span, end };
  return { ...settled({ span: range.span, end: at + range.span / 2 }, now) };
}

function settled({ span, end }, now) {
  const oldest = now - LONGEST + span;
  return end >= now ? { span, end: null } : { span, end: Math.max(end, Math.min(now, oldest)) };
}
