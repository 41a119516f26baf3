/** <ph-part-tree>: all parts; those that need attention first, then systems and what they contain.
 *
 * A part that belongs to two systems has a row in each. Dispatches `ph-select` with the name; hears
 * `ph-attention`, which lists only what needs attention.
 */

import { heardLast } from "/web/js/base/device_words.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { isSame as isSameList } from "/web/js/base/same.js";
import { FilterBar } from "/web/js/parts/filter_bar.js";
import { filtered, flatLines, matches, nameOf, parentOf, treeLines } from "/web/js/parts/lines.js";
import { devicesOf, errorsByPart, Looks, structureOf } from "/web/js/parts/part_index.js";
import { ageWords } from "/web/js/parts/row.js";
import { RowList } from "/web/js/parts/row_list.js";
import { StateTimes } from "/web/js/parts/state_times.js";

/** With more parts than this, systems are closed at first and nodes are squares as well. */
const MANY = 100;
/** As many are listed above all others while all are shown. */
const PINNED = 4;
const TOUCH = matchMedia("(pointer: coarse), (max-width: 1023px)");
/** Heights of rows in px: of one line, and with the cause on a second one. */
const HEIGHTS = { one: () => (TOUCH.matches ? 44 : 28), two: () => (TOUCH.matches ? 56 : 44) };

class PartList extends HTMLElement {
  #looks = new Looks();
  #times = new StateTimes();
  #structure = null;
  #opened = new Map();
  #openedFiltered = new Map();
  #seen = {};
  #view = null;
  #isStale = true;

  connectedCallback() {
    if (this.bar) return;
    this.bar = new FilterBar({ changed: () => this.#filter(), leave: () => this.focusRow() });
    const shared = { tell: (line) => this.#tell(line), select: (line) => this.#select(line) };
    const none = () => {};
    this.urgent = new RowList({
      ...shared, role: "listbox", label: "Needs attention", rowHeight: HEIGHTS.two(), toggle: none,
    });
    this.tree = new RowList({
      ...shared, role: "tree", label: "Systems and nodes", rowHeight: HEIGHTS.one(),
      toggle: (line) => this.#toggle(line),
    });
    this.urgent.node.classList.add("urgent");
    this.more = el("button", { type: "button", class: "small more", hidden: true, onclick: () => this.bar.attend(true) });
    this.squaresPlace = el("div", { class: "squares-place", hidden: true });
    this.summary = el("p", { class: "quiet summary" });
    this.result = el("p", { class: "quiet summary", role: "status" });
    this.append(this.bar.node, this.squaresPlace, this.result, this.urgent.node, this.more, this.summary, this.tree.node);
    TOUCH.addEventListener("change", () => this.#resize());
    document.addEventListener("ph-attention", () => this.#attend());
  }

  update(view) {
    this.#view = view;
    const { parts, devices, errors, events } = view.state;
    const isLost = view.contact.level === "lost" && view.moment === null;
    const seen = {
      parts, devices, errors, events, isLost, selected: view.selected, at: view.state.at !== null,
      second: Math.floor(view.knownAt / 1000),
    };
    if (isSame(seen, this.#seen) && !this.#isStale) return;
    if (errors !== this.#seen.errors) this.errors = errorsByPart(errors);
    const areDevicesNew = devices !== this.#seen.devices;
    this.#seen = seen;
    this.#times.take(events ?? []);
    const structure = structureOf(parts, this.#structure);
    const isNew = structure !== this.#structure;
    if (isNew) this.#restructure(structure);
    if (isNew || areDevicesNew) this.onDevice = devicesOf(structure);
    const isChanged = this.#looks.take(structure, this.errors);
    if (isNew || this.#isStale) this.#listAll();
    if (isNew || isChanged || this.#isStale) this.#listUrgent();
    this.#isStale = false;
    this.urgent.show(this.urgentLines);
    this.tree.show(this.treeLines);
    this.squares?.show(structure.nodes, this.#looks, view, isLost);
  }

  /** Go to the row that has the focus when one comes back to the list. */
  focusRow() {
    (this.bar.isAttention ? this.urgent : this.tree).focus();
  }

  #attend() {
    this.bar.attend(true);
    // On a phone the list is shown only now.
    requestAnimationFrame(() => this.urgent.focus());
  }

  #restructure(structure) {
    this.#structure = structure;
    const { names, nodes } = structure;
    setAttribute(this.bar.input, "placeholder", names.length > 1 ? `Filter ${names.length} parts` : "Filter");
    setAttribute(this.squaresPlace, "hidden", nodes.length <= MANY);
    if (nodes.length > MANY && !this.squares) this.#addSquares();
  }

  /** Few robots need them, so they are loaded for those only. */
  async #addSquares() {
    this.squares = { show() {} };
    await import("/web/js/parts/squares.js");
    this.squares = el("ph-part-squares");
    this.squaresPlace.append(this.squares);
    this.#refresh();
  }

  /** Make the lines of the tree anew; they stay the same objects until filter or systems change. */
  #listAll() {
    const { words, isAttention } = this.bar;
    this.match = words.length > 0 ? filtered(this.#structure, words) : null;
    const shown = this.match?.kept ?? null;
    this.treeLines = isAttention ? [] : treeLines(this.#structure, this.#isOpen(this.match), shown);
    this.tree.hide(isAttention);
    setAttribute(this, "data-shown", isAttention ? "attention" : "all");
  }

  #listUrgent() {
    const { words, isAttention } = this.bar;
    const { attention, begins } = this.#looks;
    const isPinned = !isAttention && words.length === 0;
    const isWanted = (name) => this.bar.lets(this.#looks.look(name)) && matches(name, words);
    const urgent = isPinned ? attention.slice(0, PINNED) : isAttention ? attention.filter(isWanted) : [];
    // The same lines, so that they are not drawn anew.
    if (!isSameList(urgent, this.urgentNames)) this.urgentLines = flatLines(urgent);
    this.urgentNames = urgent;
    this.urgent.hide(urgent.length === 0);
    const left = isPinned ? attention.slice(urgent.length) : [];
    setAttribute(this.more, "hidden", left.length === 0);
    setText(this.more, moreWords(left, begins));
    this.bar.count([...begins].map((name) => this.#looks.look(name)));
    this.#say(isAttention ? urgent.length : this.match?.found.size);
  }

  #isOpen(match) {
    if (match) return (key, name) => this.#openedFiltered.get(key) ?? match.leading.has(name);
    const { names, roots } = this.#structure;
    const isMany = names.length > MANY;
    return (key, name, level) =>
      this.#opened.get(key) ?? (!isMany || (level === 1 && roots.length === 1));
  }

  /** Say how many are shown, or that there is nothing to show and why. */
  #say(found) {
    const { names } = this.#structure;
    const { words, isAttention } = this.bar;
    const isFiltered = words.length > 0 || isAttention;
    setText(this.result, isFiltered && names.length > 0 ? this.#resultWords(found) : "");
    const count = names.length === 1 ? "1 part" : `${names.length} parts`;
    const isCalm = !isFiltered && this.#looks.attention.length === 0;
    const none = this.#seen.at ? "The model has no parts." : "No data yet.";
    setText(this.summary, names.length === 0 ? none : isCalm ? `${count}, none needs attention` : "");
  }

  #resultWords(found) {
    if (found > 0) return `${found} of ${this.#structure.names.length} shown`;
    const { words, isAttention, kind } = this.bar;
    if (words.length > 0) return `No part matches “${this.bar.input.value.trim()}”.`;
    return isAttention && kind !== "any" ? `No part is ${kind}.` : "No part needs attention.";
  }

  #tell({ key, name }) {
    const { parts } = this.#structure;
    const { devices, isLost, selected } = this.#seen;
    const part = parts[name];
    const heard = part.reachable === false ? heardLast(devices[part.device]) : null;
    const since = heard ?? (Date.parse(part.deviation_since_at) || this.#times.of(name, this.#view.knownAt));
    const [device, above] = [name, nameOf(parentOf(key))].map((each) => this.onDevice.get(each));
    return {
      part,
      // A system that is on one device as a whole tells it for all below.
      device: device && device !== above ? device : "",
      isOld: heard !== null,
      look: isLost ? "unknown" : this.#looks.look(name),
      errors: this.#looks.errors(name),
      below: this.#looks.below(name),
      age: since ? ageWords(this.#view.knownAt - since) : "",
      isSelected: name === selected,
    };
  }

  #filter() {
    this.#openedFiltered.clear();
    this.#refresh();
  }

  #refresh() {
    this.#isStale = true;
    if (this.#view) this.update(this.#view);
  }

  #resize() {
    this.tree.rows.resize(HEIGHTS.one());
    this.urgent.rows.resize(HEIGHTS.two());
    this.#refresh();
  }

  #toggle({ key, open }) {
    (this.bar.words.length > 0 ? this.#openedFiltered : this.#opened).set(key, !open);
    this.#refresh();
  }

  #select({ name }) {
    this.dispatchEvent(new CustomEvent("ph-select", { bubbles: true, detail: name }));
  }
}

/** What deviates because of others comes after those. */
function moreWords(left, begins) {
  const others = left.filter((name) => begins.has(name)).length;
  const systems = left.length - others;
  const following = `${systems} ${systems === 1 ? "system follows" : "systems follow"} from these`;
  return [others > 0 ? `${others} more` : "", systems > 0 ? following : ""].filter(Boolean).join(", ");
}

function isSame(one, other) {
  return Object.keys(one).every((key) => one[key] === other[key]);
}

customElements.define("ph-part-tree", PartList);
