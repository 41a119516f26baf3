/** Saves the events of a stretch of time as a file of JSON lines. */

import { request } from "/web/js/base/api.js";
import { el } from "/web/js/base/dom.js";

const PAGE = 1000;
const MOST_PAGES = 100;

/** Load the events between two times (ms), telling their number as it grows, and save them.
 *
 * @returns {Promise<string>} What was saved, in words.
 * @throws {ProblemError} They cannot be read.
 */
export async function exportEvents(from, to, tell) {
  const [begin, end] = [from, to].map((at) => new Date(Math.round(at)).toISOString());
  const lines = [];
  let after = 0;
  for (let page = 0; page < MOST_PAGES; page += 1) {
    const path = `/events?after=${after}&from_at=${begin}&to_at=${end}&limit=${PAGE}`;
    const { items } = await request("GET", path);
    lines.push(...items.map((event) => `${JSON.stringify(event)}\n`));
    tell(lines.length);
    if (items.length < PAGE) break;
    after = items.at(-1).id;
  }
  if (lines.length === 0) return "There are no events in this span.";
  save(`events-${begin.replaceAll(":", "")}.jsonl`, lines);
  const isCut = lines.length === PAGE * MOST_PAGES;
  return `Saved ${isCut ? "the first " : ""}${lines.length.toLocaleString("en-GB")} events.`;
}

function save(name, lines) {
  const url = URL.createObjectURL(new Blob(lines, { type: "application/jsonl" }));
  el("a", { href: url, download: name }).click();
  // The browser reads the file only after this task.
  setTimeout(() => URL.revokeObjectURL(url), 60_000);
}
