/** A chart of the history of one signal: least and greatest value, threshold, errors. */

import { el, setText } from "/web/js/base/dom.js";
import { timeOfDay } from "/web/js/base/words.js";

const SPACE = "http://www.w3.org/2000/svg";
const WIDTH = 600;
const HEIGHT = 120;
/** Share of the height that stays free above and below. */
const MARGIN = 0.08;
/** Labels of the axis are at least so far apart, in shares of the height. */
const CLEAR = 0.16;
const LAYERS = ["side", "hysteresis", "bad", "band", "limit", "line"];

/** Draws points `{at, low, high, mid, isBad}`, times in ms. */
export class Chart {
  /** `words` makes a text of a value. */
  constructor(words) {
    this.words = words;
    this.readout = el("span", { class: "chart-readout" });
    this.labels = el("div", { class: "chart-labels" });
    this.begin = el("span");
    this.end = el("span");
    this.svg = document.createElementNS(SPACE, "svg");
    this.svg.setAttribute("viewBox", `0 0 ${WIDTH} ${HEIGHT}`);
    this.svg.setAttribute("preserveAspectRatio", "none");
    for (const name of LAYERS) {
      this[name] = document.createElementNS(SPACE, "path");
      this[name].setAttribute("class", `chart-${name}`);
      this.svg.append(this[name]);
    }
    this.plot = el("div", { class: "chart-plot", "aria-hidden": "true" }, this.svg, this.labels);
    this.plot.addEventListener("pointermove", (event) => this.#tell(event));
    this.plot.addEventListener("pointerleave", () => setText(this.readout, ""));
    this.plot.addEventListener("click", (event) => showMoment(this.plot, this.#timeAt(event)));
    const axis = el("div", { class: "chart-axis" }, this.begin, this.readout, this.end);
    this.node = el("div", { class: "chart" }, this.plot, axis);
  }

  /** Draw; `limit` is `{threshold, clear, side}` or null, `gap` the time in ms that breaks a line. */
  draw({ points, from, to, limit, gap }) {
    Object.assign(this, { points, from, to });
    const [low, high] = extent(points, limit);
    const share = (value) => 1 - MARGIN - ((value - low) / (high - low)) * (1 - 2 * MARGIN);
    const x = (at) => round(((at - from) / (to - from)) * WIDTH);
    const y = (value) => round(share(value) * HEIGHT);
    const runs = runsOf(points, gap);
    this.band.setAttribute("d", runs.map((run) => bandOf(run, x, y)).join(""));
    this.line.setAttribute("d", runs.map((run) => lineOf(run, x, y)).join(""));
    this.bad.setAttribute("d", badOf(points, x, gap, to));
    this.#drawLimit(limit, y);
    this.#label(points, limit, low, high, share);
    const isDay = to - from > 12 * 3_600_000;
    setText(this.begin, isDay ? new Date(from).toLocaleString("sv-SE").slice(5, 16) : timeOfDay(from));
    setText(this.end, timeOfDay(to));
  }

  #drawLimit(limit, y) {
    const band = (a, b) => `M0 ${a}H${WIDTH}V${b}H0z`;
    const edge = limit?.side === "above" ? 0 : HEIGHT;
    this.limit.setAttribute("d", limit ? `M0 ${y(limit.threshold)}H${WIDTH}` : "");
    this.side.setAttribute("d", limit?.side ? band(y(limit.threshold), edge) : "");
    const isApart = limit && limit.clear !== limit.threshold;
    this.hysteresis.setAttribute("d", isApart ? band(y(limit.threshold), y(limit.clear)) : "");
  }

  #label(points, limit, low, high, share) {
    const wanted = limit ? [limit.threshold] : [];
    for (const value of points.length ? [high, low] : [])
      if (wanted.every((other) => Math.abs(share(other) - share(value)) > CLEAR)) wanted.push(value);
    const labels = wanted.map((value, index) => {
      const label = el("span", { class: limit && index === 0 ? "is-limit" : null }, this.words(value));
      label.style.top = `${share(value) * 100}%`;
      return label;
    });
    this.labels.replaceChildren(...labels);
  }

  #timeAt({ clientX }) {
    const { left, width } = this.plot.getBoundingClientRect();
    return this.from + ((clientX - left) / width) * (this.to - this.from);
  }

  #tell(event) {
    const at = this.#timeAt(event);
    const distance = (point) => Math.abs(point.at - at);
    const near = this.points.reduce((best, p) => (best && distance(best) <= distance(p) ? best : p), null);
    setText(this.readout, near ? `${timeOfDay(near.at)}  ${this.words(near.mid)}` : "");
  }
}

/** Let all panels show a time in ms. */
export function showMoment(node, at) {
  node.dispatchEvent(new CustomEvent("ph-show-moment", { bubbles: true, detail: { at } }));
}

/** Least and greatest value that are to be seen, the threshold among them. */
function extent(points, limit) {
  const values = points.flatMap(({ low, high }) => [low, high]);
  if (limit) values.push(limit.threshold, limit.clear);
  const low = values.reduce((a, b) => Math.min(a, b), Infinity);
  const high = values.reduce((a, b) => Math.max(a, b), -Infinity);
  if (!Number.isFinite(low)) return [0, 1];
  const half = Math.abs(low) / 20 || 0.5;
  return low === high ? [low - half, high + half] : [low, high];
}

/** Neighbours without a gap between them. */
function runsOf(points, gap) {
  const runs = [];
  points.forEach((point, index) => {
    const isNear = index > 0 && point.at - points[index - 1].at <= gap;
    if (isNear) runs.at(-1).push(point);
    else runs.push([point]);
  });
  return runs;
}

function lineOf(run, x, y) {
  const [first, ...others] = run.map(({ at, mid }) => `${x(at)} ${y(mid)}`);
  return `M${first}h.01${others.map((place) => `L${place}`).join("")}`;
}

function bandOf(run, x, y) {
  if (run.every(({ low, high }) => low === high)) return "";
  const upper = run.map(({ at, high }) => `${x(at)} ${y(high)}`);
  const lower = run.toReversed().map(({ at, low }) => `${x(at)} ${y(low)}`);
  return `M${[...upper, ...lower].join("L")}z`;
}

/** The times in which an error was on, until the next point or the end of the known. */
function badOf(points, x, gap, to) {
  let path = "";
  points.forEach(({ at, isBad }, index) => {
    if (!isBad) return;
    const end = Math.min(points[index + 1]?.at ?? to, at + gap, to);
    path += `M${x(at)} 0H${x(end)}V${HEIGHT}H${x(at)}z`;
  });
  return path;
}

function round(value) {
  return Math.round(value * 10) / 10;
}
