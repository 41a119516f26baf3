/** <ph-sparkline>: the last minute of a signal as a line, with its threshold.
 *
 * It is drawn as SVG, so that it is sharp at each density and has the colours of the style sheet.
 * Where an error was on, its ground is shaded. A signal without a number is a bar, the higher the
 * worse. `show` draws at most once a second; who has many calls it for those that are seen.
 */

import { setAttribute } from "/web/js/base/dom.js";
import { SPAN_S, trendOf } from "/web/js/base/trends.js";

const SPACE = "http://www.w3.org/2000/svg";
const HEIGHT = 20;
/** Room above and below, so that a line at the edge has its whole width. */
const MARGIN = 2;

class Sparkline extends HTMLElement {
  #drawn = "";

  /** Draw the signal named `name` as it is in `view.state`. */
  show(name, view) {
    const key = `${name} ${Math.floor(view.serverNow / 1000)} ${Boolean(view.moment)}`;
    if (key === this.#drawn) return;
    this.#drawn = key;
    const signal = view.state.signals[name];
    if (!signal) return;
    if (!this.lines) this.#build();
    const { trend, end } = trendOf(name, signal, view);
    const points = trend.points(end);
    const limit = trend.isNumber ? signal.settings.threshold : undefined;
    const y = scale(points, trend, limit);
    setAttribute(this.bad, "d", shadeOf(points));
    setAttribute(this.line, "d", trend.isNumber ? lineOf(points, y) : "");
    setAttribute(this.bar, "d", trend.isNumber ? "" : barOf(points, y));
    setAttribute(this.limit, "d", limit === undefined ? "" : `M0 ${y(limit)}H${SPAN_S}`);
  }

  #build() {
    const svg = document.createElementNS(SPACE, "svg");
    svg.setAttribute("viewBox", `0 0 ${SPAN_S} ${HEIGHT}`);
    svg.setAttribute("preserveAspectRatio", "none");
    svg.setAttribute("aria-hidden", "true");
    this.lines = ["bad", "bar", "limit", "line"].map((name) => {
      const path = document.createElementNS(SPACE, "path");
      path.setAttribute("class", `spark-${name}`);
      this[name] = path;
      return path;
    });
    svg.append(...this.lines);
    this.append(svg);
  }
}

/** From a value to a height; the threshold is always in sight, so that the distance to it is. */
function scale(points, { isNumber, members }, limit) {
  let low = isNumber ? (limit ?? Infinity) : -0.6;
  let high = isNumber ? (limit ?? -Infinity) : Math.max(1, members.length - 1);
  for (const point of points) {
    if (!point) continue;
    low = Math.min(low, point.low);
    high = Math.max(high, point.high);
  }
  const span = high - low;
  const room = HEIGHT - 2 * MARGIN;
  if (!(span > 0)) return () => HEIGHT / 2;
  return (value) => round(HEIGHT - MARGIN - ((value - low) / span) * room);
}

/** A line through what was known; where nothing was, it is broken. */
function lineOf(points, y) {
  let path = "";
  let isOn = false;
  points.forEach((point, index) => {
    if (!point) {
      isOn = false;
      return;
    }
    const { low, high, last } = point;
    path += `${isOn ? "L" : "M"}${index + 0.5} ${y(low === high ? last : low)}`;
    if (low !== high) path += `V${y(high)}V${y(last)}`;
    else if (!isOn) path += "h.01";
    isOn = true;
  });
  return path;
}

function barOf(points, y) {
  let path = "";
  for (const [begin, end, high] of runs(points, (point) => point?.high))
    path += `M${begin} ${HEIGHT - MARGIN}V${y(high)}H${end}V${HEIGHT - MARGIN}z`;
  return path;
}

function shadeOf(points) {
  let path = "";
  for (const [begin, end] of runs(points, (point) => (point?.bad ? 1 : undefined)))
    path += `M${begin} 0H${end}V${HEIGHT}H${begin}z`;
  return path;
}

/** Yield `[begin, end, value]` of neighbours with an equal value; undefined ones are left out. */
function* runs(points, valueOf) {
  let begin = 0;
  for (let index = 1; index <= points.length; index++) {
    const value = valueOf(points[begin]);
    if (index < points.length && valueOf(points[index]) === value) continue;
    if (value !== undefined) yield [begin, index, value];
    begin = index;
  }
}

function round(value) {
  return Math.round(value * 100) / 100;
}

customElements.define("ph-sparkline", Sparkline);
