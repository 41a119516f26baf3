/** The timeline as a table, for whoever reads rather than sees it. */

import { el } from "/web/js/base/dom.js";
import { timeAndDay } from "/web/js/base/words.js";
import { tableRows, timesOf } from "/web/js/timeline/describe.js";

const MOST = 200;
const COLUMNS = ["Lane", "What", "When", "By"];

/** Return the nodes of the table, the newest first. */
export function tableOf(lanes, dark, { from, to, now }) {
  const service = { key: "service", name: "Service", intervals: [], unknown: dark };
  const { rows, left } = tableRows([service, ...lanes], from, to, MOST);
  const caption = `From ${timeAndDay(from)} to ${timeAndDay(to)}, the newest first`;
  const head = el("tr", {}, ...COLUMNS.map((name) => el("th", { scope: "col" }, name)));
  const body = rows.map((row) =>
    el(
      "tr",
      { "data-tone": row.tone ?? "unknown" },
      el("th", { scope: "row" }, row.lane.name),
      el("td", {}, row.text),
      el("td", {}, el("time", { datetime: new Date(Math.max(row.begin, from)).toISOString() }, timesOf(seen(row, from), now))),
      el("td", {}, row.who ?? ""),
    ),
  );
  if (rows.length === 0) body.push(el("tr", {}, el("td", { colspan: COLUMNS.length }, "Nothing happened in this span.")));
  const table = el("table", {}, el("caption", {}, caption), el("thead", {}, head), el("tbody", {}, ...body));
  const more = `${left.toLocaleString("en-GB")} earlier rows are not listed: choose a shorter span.`;
  return left ? [table, el("p", { class: "quiet" }, more)] : [table];
}

/** What began before anything was recorded begins with the span. */
function seen(row, from) {
  return row.begin === -Infinity ? { ...row, begin: from, cut: true } : row;
}
