/** A long list of which only the rows that can be seen are in the document.
 *
 * The list is as high as all its rows; each row has its place by `top`. The row at `kept` is always
 * there, so that focus survives scrolling. The layout is read when something is scrolled or resized,
 * never while frames are drawn.
 */

/** Rows drawn beyond each edge, so that a fast wheel does not show an empty list. */
const BEYOND = 8;
/** Drawn before the first measurement. */
const AT_FIRST = 40;

export class Rows {
  #lines = [];
  #places = new Map();
  #rows = new Map();
  #window = [0, AT_FIRST];
  #isAsked = false;
  kept = null;
  /** Of the list, in px. */
  width = 300;

  /** `scroller` holds `list`; `make(line)` returns `{item, ...}`, `fill(row, line)` brings it up to date. */
  constructor({ scroller, list, rowHeight, make, fill }) {
    Object.assign(this, { scroller, list, rowHeight, make, fill });
    const ask = () => this.#askToMeasure();
    new ResizeObserver(([{ contentRect }]) => {
      this.width = contentRect.width;
      this.#draw();
      ask();
    }).observe(scroller);
    // On a phone the page scrolls, elsewhere the list.
    document.addEventListener("scroll", ask, { capture: true, passive: true });
    addEventListener("resize", ask, { passive: true });
  }

  /** Draw what can be seen of these lines. */
  show(lines) {
    if (this.#lines !== lines) {
      if (this.#lines.length !== lines.length) this.#setHeight(lines.length);
      this.#lines = lines;
      this.#places = new Map(lines.map((line, at) => [line.key, at]));
    }
    this.#draw();
  }

  /** Take another height of rows, as of another kind of them. */
  resize(rowHeight) {
    if (rowHeight === this.rowHeight) return;
    this.rowHeight = rowHeight;
    this.#setHeight(this.#lines.length);
    for (const [key, { item }] of this.#rows) this.#place(item, this.#places.get(key));
    this.#askToMeasure();
  }

  indexOf(key) {
    return this.#places.get(key) ?? -1;
  }

  line(at) {
    return this.#lines[at];
  }

  get length() {
    return this.#lines.length;
  }

  /** Return the element of a line, drawn even where it cannot be seen. */
  item(key) {
    this.kept = key;
    this.#draw();
    return this.#rows.get(key)?.item ?? null;
  }

  /** Measure again, since something above the list may have grown. */
  #askToMeasure() {
    if (this.#isAsked) return;
    this.#isAsked = true;
    requestAnimationFrame(() => {
      this.#isAsked = false;
      if (!this.list.isConnected) return;
      const { top } = this.list.getBoundingClientRect();
      const frame = this.scroller.getBoundingClientRect();
      const [from, to] = [Math.max(frame.top, 0) - top, Math.min(frame.bottom, innerHeight) - top];
      const first = Math.floor(from / this.rowHeight) - BEYOND;
      const last = Math.ceil(to / this.rowHeight) + BEYOND;
      if (first === this.#window[0] && last === this.#window[1]) return;
      this.#window = [first, last];
      this.#draw();
    });
  }

  #draw() {
    const [from, to] = this.#window;
    const wanted = this.#lines.slice(Math.max(0, from), Math.max(0, to));
    const kept = this.indexOf(this.kept);
    if (kept >= 0 && kept < from) wanted.unshift(this.#lines[kept]);
    else if (kept >= to) wanted.push(this.#lines[kept]);
    const keys = new Set(wanted.map(({ key }) => key));
    const free = [];
    for (const [key, row] of this.#rows) {
      if (keys.has(key)) continue;
      this.#rows.delete(key);
      row.item.remove();
      free.push(row);
    }
    let next = this.list.firstElementChild;
    for (const line of wanted) {
      const row = this.#rows.get(line.key) ?? free.pop() ?? this.make();
      this.#rows.set(line.key, row);
      this.#place(row.item, this.#places.get(line.key));
      // A row that stays where it is keeps the focus.
      if (row.item === next) next = next.nextElementSibling;
      else this.list.insertBefore(row.item, next);
      this.fill(row, line);
    }
  }

  #place(item, at) {
    if (item.place === at * this.rowHeight) return;
    item.place = at * this.rowHeight;
    item.style.top = `${item.place}px`;
  }

  #setHeight(count) {
    this.list.style.height = `${count * this.rowHeight}px`;
  }
}
