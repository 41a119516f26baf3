/** A list of parts that is used from the keyboard: one of its rows has the focus, arrows move it.
 *
 * As a tree (WAI-ARIA) its systems open and close; as a listbox its rows are flat.
 */

import { el, setAttribute } from "/web/js/base/dom.js";
import { parentOf } from "/web/js/parts/lines.js";
import { fillRow, makeRow } from "/web/js/parts/row.js";
import { Rows } from "/web/js/parts/rows.js";

const PAGE_ROWS = 10;
/** Letters that follow one another faster than this make one word. */
const WORD_PAUSE_MS = 700;
const ROLES = { tree: "treeitem", listbox: "option" };

export class RowList {
  #word = "";
  #wordAt = 0;

  /** `tell(line)` returns what is known of the part of a line; `select` and `toggle` take a line. */
  constructor({ role, label, rowHeight, tell, select, toggle }) {
    Object.assign(this, { tell, select, toggle });
    this.list = el("ul", { role, "aria-label": label });
    this.node = el("div", { class: "rows" }, this.list);
    this.rows = new Rows({
      scroller: this.node,
      list: this.list,
      rowHeight,
      make: () => makeRow(ROLES[role]),
      fill: (row, line) => fillRow(row, line, this.#told(line)),
    });
    this.list.addEventListener("click", (event) => this.#click(event));
    this.list.addEventListener("keydown", (event) => this.#key(event));
    this.list.addEventListener("focusin", ({ target }) => this.#keep(target.line?.key));
  }

  /** Show these lines; a row that had the focus keeps it, or the one at its place gets it. */
  show(lines) {
    const held = this.list.contains(document.activeElement);
    if (lines !== this.lines && !lines.some(({ key }) => key === this.rows.kept))
      this.rows.kept = nearest(lines, this.rows.indexOf(this.rows.kept))?.key ?? null;
    this.lines = lines;
    this.rows.show(lines);
    if (held && !this.list.contains(document.activeElement))
      this.rows.item(this.rows.kept)?.focus({ preventScroll: true });
  }

  /** Give the focus to the row that has it when one comes to the list. */
  focus() {
    this.#focus(this.rows.indexOf(this.rows.kept));
  }

  hide(isHidden) {
    setAttribute(this.node, "hidden", isHidden);
  }

  #told(line) {
    if (line.heading) return NOTHING;
    const { kept, width } = this.rows;
    return { ...this.tell(line), hasFocus: line.key === kept, width };
  }

  #keep(key) {
    if (!key || key === this.rows.kept) return;
    this.rows.item(key);
  }

  #focus(at) {
    const line = this.rows.line(at);
    if (!line) return;
    const item = this.rows.item(line.key);
    item.focus({ preventScroll: true });
    item.scrollIntoView({ block: "nearest" });
  }

  /** The next row in a direction; headings are passed over. */
  #next(at, step) {
    let next = at + step;
    while (this.rows.line(next)?.heading) next += step;
    return this.rows.line(next) ? next : at;
  }

  #click(event) {
    const line = event.target.closest("li")?.line;
    if (!line?.name) return;
    this.#focus(this.rows.indexOf(line.key));
    if (event.target.closest(".twist") && line.open !== null) this.toggle(line);
    else this.select(line);
  }

  #key(event) {
    const line = event.target.closest("li")?.line;
    if (!line || event.ctrlKey || event.altKey || event.metaKey) return;
    const at = this.rows.indexOf(line.key);
    const isWord = event.timeStamp - this.#wordAt < WORD_PAUSE_MS;
    const go = this.#moves(line, at)[event.key];
    if (go && !(event.key === " " && isWord)) go();
    else if (event.key.length === 1) this.#typeAhead(event, at, isWord);
    else return;
    event.preventDefault();
  }

  #moves(line, at) {
    const { length } = this.rows;
    return {
      ArrowDown: () => this.#focus(this.#next(at, 1)),
      ArrowUp: () => this.#focus(this.#next(at, -1)),
      PageDown: () => this.#focus(this.#next(Math.min(at + PAGE_ROWS, length) - 1, 1)),
      PageUp: () => this.#focus(this.#next(Math.max(at - PAGE_ROWS, -1) + 1, -1)),
      Home: () => this.#focus(this.#next(-1, 1)),
      End: () => this.#focus(this.#next(length, -1)),
      ArrowRight: () => {
        if (line.open === false) this.toggle(line);
        else if (line.open) this.#focus(this.#next(at, 1));
      },
      ArrowLeft: () => {
        if (line.open) this.toggle(line);
        else this.#focus(this.rows.indexOf(parentOf(line.key)));
      },
      Enter: () => this.select(line),
      " ": () => this.select(line),
    };
  }

  /** One letter goes to the next name that begins with it; a word begun goes on at the row itself. */
  #typeAhead({ key, timeStamp }, at, isWord) {
    const letter = key.toLowerCase();
    // The same letter again goes on to the next such name.
    const goesOn = isWord && this.#word !== letter;
    this.#word = goesOn ? this.#word + letter : letter;
    this.#wordAt = timeStamp;
    const { length } = this.rows;
    for (let step = goesOn ? 0 : 1; step <= length; step += 1) {
      const place = (at + step) % length;
      if (this.rows.line(place).shown?.toLowerCase().startsWith(this.#word)) return this.#focus(place);
    }
  }
}

const NOTHING = {};

function nearest(lines, place) {
  return lines.slice(Math.max(0, place)).find(({ name }) => name) ?? lines.find(({ name }) => name);
}
