/** The lanes on a canvas, their names beside it, and what is under a place. */

import { el, renderOnce, setAttribute } from "/web/js/base/dom.js";
import { AXIS_PX, drawTimeline, INKS, LANE_PX, PAD_PX, ROW_PX } from "/web/js/timeline/draw.js";
import { marksOf, rowsOf, timeAt } from "/web/js/timeline/marks.js";
import { scaleOf } from "/web/js/timeline/range.js";

/** So many rows for what overlaps; the last one takes the rest, with its number. */
const MOST_ROWS = 3;
const NEAR_PX = 3;
const DARK = matchMedia("(prefers-color-scheme: dark)");
const FORCED = matchMedia("(forced-colors: active)");

export class LanesView {
  #rows = [];
  #scale = null;
  #width = 0;
  #ink = null;
  #inkKey = "";

  /** @param resized Called when the canvas has another width. */
  constructor(resized) {
    this.canvas = el("canvas", {
      tabindex: 0,
      role: "slider",
      "aria-label": "Timeline",
      "aria-describedby": "timeline-keys",
    });
    this.context = this.canvas.getContext("2d", { alpha: false });
    this.names = el("ul", { class: "lane-names" });
    this.probe = el("span", { hidden: true });
    this.box = el("div", { class: "lane-box" }, this.canvas);
    this.root = el("div", { class: "lanes" }, this.names, this.box, this.probe);
    new ResizeObserver(([{ contentRect }]) => {
      this.#width = Math.floor(contentRect.width);
      resized();
    }).observe(this.box);
    this.root.addEventListener("scroll", resized, { passive: true });
  }

  get width() {
    return this.#width;
  }

  /** What the colours depend on. */
  get scheme() {
    const { theme } = document.documentElement.dataset;
    return `${theme} ${DARK.matches} ${FORCED.matches}`;
  }

  get scale() {
    return this.#scale;
  }

  /** Draw. `shown` is `{lanes, dark, range, now, pinned, isPending, cursor, chosen, namesKey}`. */
  draw(shown, nameOf) {
    if (this.#width === 0) return;
    this.#scale = scaleOf(shown.range, shown.now, this.#width);
    const height = this.#place(shown.lanes, shown.chosen);
    this.#size(height);
    renderOnce(this.names, this.#namesKey(shown.namesKey), () => [
      el("li", { class: "axis-name", "aria-hidden": "true" }),
      ...this.#rows.map((row) => nameOf(row.lane, row.height)),
    ]);
    const scene = { ...shown, rows: this.#rows, scale: this.#scale, height };
    drawTimeline(this.context, this.#inkNow(), devicePixelRatio, { ...scene, top: this.root.scrollTop });
  }

  /** What is at a place: `{at, lane, items}`; without lane above all, without items beside them. */
  at(x, y) {
    if (!this.#scale) return null;
    const row = this.#rows.find((one) => y >= one.y && y < one.y + one.height);
    const at = timeAt(this.#scale, x);
    if (!row) return { at, lane: null, items: [] };
    const n = Math.min(row.rows.length - 1, Math.max(0, Math.floor((y - row.y - PAD_PX) / ROW_PX)));
    const near = (mark) => Math.max(mark.x0 - x, x - mark.x1, 0);
    const marks = row.rows[n].filter((mark) => near(mark) <= NEAR_PX);
    marks.sort((a, b) => near(a) - near(b));
    return { at, lane: row.lane, items: marks[0]?.items ?? [] };
  }

  /** The middle of a lane, px below the top of the canvas. */
  middleOf(key) {
    const row = this.#rows.find(({ lane }) => lane.key === key);
    return row ? row.y + row.height / 2 : AXIS_PX;
  }

  #place(lanes, chosen) {
    let y = AXIS_PX;
    this.#rows = lanes.map((lane) => {
      const isSpan = lane.key === "errors" || lane.key === "holds";
      const { from, to } = this.#scale;
      const seen = lane.intervals.filter(({ begin, end }) => end >= from && begin <= to);
      const rows = isSpan ? rowsOf(seen, MOST_ROWS) : [seen];
      const height = LANE_PX + (rows.length - 1) * ROW_PX;
      const marks = rows.map((row) => marksOf(row, this.#scale));
      const placed = { lane, y, height, rows: marks, isChosen: lane.key === chosen };
      y += height;
      return placed;
    });
    return y;
  }

  #namesKey(key) {
    return [key, ...this.#rows.map(({ lane, height }) => `${lane.key} ${height}`)].join();
  }

  /** Setting the size clears a canvas, so only if it differs. */
  #size(height) {
    const [across, down] = [this.#width, height].map((px) => Math.round(px * devicePixelRatio));
    if (this.canvas.width === across && this.canvas.height === down) return;
    Object.assign(this.canvas, { width: across, height: down });
    Object.assign(this.canvas.style, { width: `${this.#width}px`, height: `${height}px` });
  }

  /** The colours as the scheme resolves them: a canvas does not know what `light-dark()` is. */
  #inkNow() {
    const key = this.scheme;
    if (this.#ink && key === this.#inkKey) return this.#ink;
    this.#inkKey = key;
    setAttribute(this.probe, "hidden", false);
    const style = getComputedStyle(this.probe);
    this.#ink = { font: `11px ${style.fontFamily}` };
    for (const [name, token] of Object.entries(INKS)) {
      this.probe.style.color = `var(--${token})`;
      this.#ink[name] = style.color;
    }
    setAttribute(this.probe, "hidden", true);
    return this.#ink;
  }
}
