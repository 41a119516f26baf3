/** Intervals and marks in words: pure functions. */

import { duration, timeOfDay } from "/web/js/base/words.js";

const MILLISECONDS = 3000;
const NAMED = 4;

/** The time of day, with milliseconds where the span is so short that they are seen. */
export function clockWords(at, span = Infinity) {
  const ms = span < 10 * MILLISECONDS ? `.${String(Math.floor(at) % 1000).padStart(3, "0")}` : "";
  return timeOfDay(at) + ms;
}

/** From when to when, and for how long. */
export function timesOf({ begin, end, cut, lost }, now) {
  if (begin === end) return timeOfDay(begin);
  const from = cut ? `before ${timeOfDay(begin)}` : timeOfDay(begin);
  if (end === Infinity) return `since ${from}, ${duration(now - begin)}`;
  const until = lost ? `at least ${timeOfDay(end)}` : timeOfDay(end);
  return `${from} to ${until}, ${duration(end - begin)}`;
}

/** The lines of a mark for the person who points at it: `{title, lines}`. */
export function markWords(lane, items, now) {
  if (items.length === 1) {
    const [item] = items;
    const who = item.who ? [`by ${item.who}`] : [];
    return { title: item.text, lines: [timesOf(item, now), ...who] };
  }
  const [first, last] = [items[0], items.at(-1)];
  const counts = new Map();
  for (const { short, text } of items) {
    const name = short ?? text;
    counts.set(name, (counts.get(name) ?? 0) + 1);
  }
  const named = [...counts].slice(0, NAMED).map(([name, count]) => `${count} × ${name}`);
  if (counts.size > NAMED) named.push(`${counts.size - NAMED} more`);
  const end = last.end === Infinity ? now : last.end;
  const times = `${timeOfDay(first.begin)} to ${timeOfDay(end)}`;
  return { title: `${items.length} in ${lane.name.toLowerCase()}`, lines: [times, ...named] };
}

/** What a lane has at a moment: what ends with it is over, as in the frame of that moment. */
export function itemsAt({ intervals }, at) {
  return intervals.filter((one) => isIn(one, at));
}

function isIn({ begin, end }, at) {
  return begin <= at && (at < end || begin === at);
}

/** What a lane says of a moment, where no mark is. */
export function momentWords(lane, at) {
  const gap = lane.unknown.find((one) => isIn(one, at));
  if (gap) return gap.text;
  const found = itemsAt(lane, at).map(({ text }) => text);
  return found.length ? found.join("; ") : NOTHING[lane.key] ?? "not known";
}

const NOTHING = {
  task: "no task",
  errors: "no error",
  holds: "no hold",
  commands: "no command",
};

/** The rows of the table: the newest first. */
export function tableRows(lanes, from, to, most) {
  const rows = lanes.flatMap((lane) => [
    ...lane.intervals.filter(({ tone }) => tone !== "none").map((one) => ({ lane, ...one })),
    ...lane.unknown.map((one) => ({ lane, ...one })),
  ]);
  const shown = rows.filter(({ begin, end }) => begin <= to && end >= from);
  shown.sort((a, b) => b.begin - a.begin);
  return { rows: shown.slice(0, most), left: Math.max(0, shown.length - most) };
}
