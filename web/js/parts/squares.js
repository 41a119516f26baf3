/** <ph-part-squares>: a small square for each node, so that hundreds are seen at once.
 *
 * Pointing at one, or going to it with the arrows, names it; a click or Enter selects it. To a
 * screen reader it is a listbox of which the option in focus is there.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { label } from "/web/js/base/words.js";
import { columnsFor, SQUARE_LOOKS, squareAt, squarePaths } from "/web/js/parts/square_shapes.js";
import { LOOK_WORDS } from "/web/js/parts/verdict.js";

/** One cannot follow more changes of a second than this allows. */
const PAUSE_MS = 250;
/** A square is no larger on a wide screen. */
const LARGEST_PX = 13;
const SVG = "http://www.w3.org/2000/svg";

class PartSquares extends HTMLElement {
  #names = [];
  #drawnAt = -Infinity;
  #timer = null;
  #pointed = -1;
  #focused = 0;
  #hasFocus = false;

  connectedCallback() {
    this.paths = Object.fromEntries(SQUARE_LOOKS.map((look) => [look, svg("path", { class: look })]));
    this.ring = svg("rect", { class: "ring", width: 1, height: 1 });
    this.svg = svg("svg", { "aria-hidden": "true" }, ...Object.values(this.paths), this.ring);
    this.option = el("div", { role: "option", id: "square-in-focus", class: "visually-hidden" });
    this.box = el(
      "div",
      { role: "listbox", tabindex: 0, "aria-label": "Nodes as squares", "aria-activedescendant": "square-in-focus" },
      this.svg,
      this.option,
    );
    this.words = el("p", { class: "quiet" });
    this.append(this.box, this.words);
    this.svg.addEventListener("pointermove", (event) => this.#point(this.#at(event)));
    this.svg.addEventListener("pointerleave", () => this.#point(-1));
    this.svg.addEventListener("click", (event) => this.#select(this.#at(event)));
    this.box.addEventListener("keydown", (event) => this.#key(event));
    this.box.addEventListener("focus", () => this.#hold(true));
    this.box.addEventListener("blur", () => this.#hold(false));
  }

  /** Show nodes with these looks; the newest is drawn at most four times a second. */
  show(names, looks, { state, selected }, isLost) {
    Object.assign(this, { looks, parts: state.parts, selected, isLost });
    this.#names = names;
    if (this.#timer !== null) return;
    const wait = this.#drawnAt + PAUSE_MS - performance.now();
    if (wait <= 0) this.#draw();
    else this.#timer = setTimeout(() => this.#draw(), wait);
  }

  #draw() {
    this.#timer = null;
    this.#drawnAt = performance.now();
    const count = this.#names.length;
    this.columns = columnsFor(count);
    const rows = Math.ceil(count / this.columns);
    const looks = this.#names.map((name) => (this.isLost ? "unknown" : this.looks.look(name)));
    const key = looks.join();
    if (key !== this.key) {
      this.key = key;
      this.svg.style.maxWidth = `${this.columns * LARGEST_PX}px`;
      setAttribute(this.svg, "viewBox", `-0.1 -0.1 ${this.columns + 0.2} ${rows + 0.2}`);
      for (const [look, path] of Object.entries(squarePaths(looks, this.columns)))
        setAttribute(this.paths[look], "d", path);
      this.total = totalWords(count, looks);
    }
    this.#mark();
  }

  /** The ring is at what is pointed at or in focus, else at the selected part. */
  #mark() {
    const named = this.#pointed >= 0 ? this.#pointed : this.#hasFocus ? this.#focused : -1;
    const at = named >= 0 ? named : this.#names.indexOf(this.selected);
    setAttribute(this.ring, "visibility", at >= 0 ? null : "hidden");
    if (at >= 0) {
      setAttribute(this.ring, "x", at % this.columns);
      setAttribute(this.ring, "y", Math.floor(at / this.columns));
    }
    setText(this.words, named >= 0 ? this.#wordsOf(named) : this.total);
    setText(this.option, this.#wordsOf(this.#focused));
    setAttribute(this.option, "aria-posinset", this.#focused + 1);
    setAttribute(this.option, "aria-setsize", this.#names.length);
    setAttribute(this.option, "aria-selected", String(this.#names[this.#focused] === this.selected));
  }

  #wordsOf(at) {
    const name = this.#names[at];
    const look = this.isLost ? "" : LOOK_WORDS[this.looks.look(name)];
    return [`${name}: ${label(this.parts[name].actual)}`, look].filter(Boolean).join(", ");
  }

  #at({ clientX, clientY }) {
    const { left, top, width } = this.svg.getBoundingClientRect();
    const cell = width / (this.columns + 0.2);
    const [x, y] = [(clientX - left) / cell - 0.1, (clientY - top) / cell - 0.1];
    return squareAt(x, y, this.columns, this.#names.length);
  }

  #point(at) {
    if (at === this.#pointed) return;
    this.#pointed = at;
    this.#mark();
  }

  #hold(hasFocus) {
    this.#hasFocus = hasFocus;
    const selected = this.#names.indexOf(this.selected);
    if (hasFocus && selected >= 0) this.#focused = selected;
    this.#mark();
  }

  #key(event) {
    const last = this.#names.length - 1;
    const steps = {
      ArrowRight: this.#focused + 1,
      ArrowLeft: this.#focused - 1,
      ArrowDown: this.#focused + this.columns,
      ArrowUp: this.#focused - this.columns,
      Home: 0,
      End: last,
    };
    if (event.key === "Enter" || event.key === " ") this.#select(this.#focused);
    else if (event.key in steps) this.#focused = Math.min(last, Math.max(0, steps[event.key]));
    else return;
    event.preventDefault();
    this.#mark();
  }

  #select(at) {
    if (at < 0) return;
    this.#focused = at;
    this.dispatchEvent(new CustomEvent("ph-select", { bubbles: true, detail: this.#names[at] }));
  }
}

/** "300 nodes: 3 unreachable, 5 deviate", the worst first. */
function totalWords(count, looks) {
  const said = [...SQUARE_LOOKS]
    .reverse()
    .map((look) => [looks.filter((one) => one === look).length, look])
    .filter(([some, look]) => some > 0 && look !== "normal")
    .map(([some, look]) => `${some} ${TALLY[look]}`);
  return `${count} nodes: ${said.join(", ") || "all normal"}`;
}

const TALLY = {
  changing: "changing",
  unknown: "not known",
  warned: "with a warning",
  deviating: "deviating",
  faulty: "faulty",
  unreachable: "unreachable",
};

function svg(tag, attributes, ...children) {
  const node = document.createElementNS(SVG, tag);
  for (const [name, value] of Object.entries(attributes)) node.setAttribute(name, value);
  node.append(...children);
  return node;
}

customElements.define("ph-part-squares", PartSquares);
