/** <ph-part-tree>: systems and their parts as a tree, after the WAI-ARIA tree pattern.
 *
 * A part that belongs to two systems has a row in each. Dispatches `ph-select` with the name.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { duration } from "/web/js/base/words.js";

class PartTree extends HTMLElement {
  #rows = new Map();
  #collapsed = new Set();
  #focused = null;
  #view = null;

  connectedCallback() {
    this.list = el("ul", { role: "tree", "aria-label": "Systems and nodes" });
    this.empty = el("p", { class: "quiet" }, "No data yet.");
    this.append(this.list, this.empty);
    this.list.addEventListener("keydown", (event) => this.#key(event));
    this.list.addEventListener("click", (event) => this.#click(event));
  }

  update(view) {
    this.#view = view;
    const lines = visibleLines(view.state.parts, this.#collapsed);
    setAttribute(this.empty, "hidden", lines.length > 0);
    const key = lines.map((line) => `${line.path}:${line.open}`).join();
    if (this.key !== key) this.#build(key, lines);
    for (const line of lines) this.#fill(line);
  }

  /** Go to the row that has the focus when one comes back to the tree. */
  focusRow() {
    const row = this.#rows.get(this.#focused)?.item;
    row?.scrollIntoView({ block: "center" });
    row?.focus({ preventScroll: true });
  }

  #build(key, lines) {
    this.key = key;
    const held = this.list.contains(document.activeElement);
    const rows = new Map();
    for (const line of lines) rows.set(line.path, this.#rows.get(line.path) ?? makeRow(line));
    this.#rows = rows;
    if (!rows.has(this.#focused)) this.#focused = lines[0]?.path ?? null;
    this.list.replaceChildren(...[...rows.values()].map((row) => row.item));
    if (held) this.#focus(this.#focused);
  }

  #fill({ path, part, level, open, index, count }) {
    const { item, name, kind, dot, dotText, pills, note } = this.#rows.get(path);
    setAttribute(item, "aria-level", level);
    setAttribute(item, "aria-posinset", index);
    setAttribute(item, "aria-setsize", count);
    setAttribute(item, "aria-expanded", open === null ? null : String(open));
    setAttribute(item, "aria-selected", String(part.name === this.#view.selected));
    setAttribute(item, "tabindex", path === this.#focused ? 0 : -1);
    const contact = this.#view.contact.level === "lost" ? "unknown" : reachability(part);
    setAttribute(dot, "data-reachable", contact);
    setText(dotText, REACHABLE[contact]);
    setText(name, part.name);
    setText(kind, part.kind ?? "");
    pills.show(part);
    const said = noteWords(part, this.#view.knownAt);
    setAttribute(note, "hidden", said === "");
    setText(note, said);
  }

  #click(event) {
    const item = event.target.closest("[role=treeitem]");
    if (!item) return;
    this.#focus(item.dataset.path);
    if (event.target.closest(".twist") && item.hasAttribute("aria-expanded")) this.#toggle(item);
    else this.#select(item);
  }

  #key(event) {
    const item = event.target.closest("[role=treeitem]");
    if (!item || event.ctrlKey || event.altKey || event.metaKey) return;
    const order = [...this.#rows.keys()];
    const at = order.indexOf(item.dataset.path);
    const open = item.getAttribute("aria-expanded");
    const moves = {
      ArrowDown: () => this.#focus(order[at + 1]),
      ArrowUp: () => this.#focus(order[at - 1]),
      Home: () => this.#focus(order[0]),
      End: () => this.#focus(order.at(-1)),
      ArrowRight: () =>
        open === "false" ? this.#toggle(item) : open && this.#focus(order[at + 1]),
      ArrowLeft: () =>
        open === "true" ? this.#toggle(item) : this.#focus(parentOf(item.dataset.path)),
      Enter: () => this.#select(item),
      " ": () => this.#select(item),
    };
    if (moves[event.key]) moves[event.key]();
    else if (event.key.length === 1) this.#typeAhead(event.key, order, at);
    else return;
    event.preventDefault();
  }

  #typeAhead(letter, order, at) {
    const next = [...order.slice(at + 1), ...order.slice(0, at + 1)];
    this.#focus(next.find((path) => nameOf(path).toLowerCase().startsWith(letter.toLowerCase())));
  }

  #toggle(item) {
    const { path } = item.dataset;
    if (!this.#collapsed.delete(path)) this.#collapsed.add(path);
    this.update(this.#view);
  }

  #select(item) {
    this.dispatchEvent(
      new CustomEvent("ph-select", { bubbles: true, detail: nameOf(item.dataset.path) }),
    );
  }

  #focus(path) {
    if (!this.#rows.has(path)) return;
    this.#focused = path;
    for (const [other, { item }] of this.#rows)
      setAttribute(item, "tabindex", other === path ? 0 : -1);
    this.#rows.get(path).item.focus();
  }
}

// Paths are joined by a character that no name contains; names may contain slashes.
const JOINT = "\n";

function nameOf(path) {
  return path.slice(path.lastIndexOf(JOINT) + 1);
}

function parentOf(path) {
  return path.slice(0, Math.max(0, path.lastIndexOf(JOINT)));
}

function visibleLines(parts, collapsed) {
  const owned = new Set(Object.values(parts).flatMap((part) => part.parts ?? []));
  const lines = [];
  const add = (names, parent, level) =>
    names.forEach((name, index) => {
      const path = parent ? parent + JOINT + name : name;
      const children = (parts[name].parts ?? []).filter((child) => parts[child]);
      const open = children.length ? !collapsed.has(path) : null;
      lines.push({ path, part: parts[name], level, open, index: index + 1, count: names.length });
      if (open) add(children, path, level + 1);
    });
  add(
    Object.keys(parts).filter((name) => !owned.has(name)),
    "",
    1,
  );
  return lines;
}

function makeRow({ path, level }) {
  const row = {
    name: el("span", { class: "name" }),
    kind: el("span", { class: "kind" }),
    dot: el("span", { class: "dot" }),
    dotText: el("span", { class: "visually-hidden" }),
    pills: el("ph-pills"),
    note: el("span", { class: "note" }),
  };
  const twist = el("span", { class: "twist", "aria-hidden": "true" });
  const head = el("span", { class: "head" }, twist, row.dot, row.name, row.kind, row.dotText);
  const item = el(
    "li",
    { role: "treeitem", class: `row level-${Math.min(level, 6)}` },
    head,
    row.pills,
    row.note,
  );
  item.dataset.path = path;
  return { ...row, item };
}

const REACHABLE = {
  true: "reachable",
  false: "unreachable",
  unknown: "not known whether it is reachable",
};

function reachability({ reachable }) {
  return String(reachable !== false);
}

function noteWords(part, now) {
  if (part.reachable === false && part.kind === "node") return "unreachable";
  if (part.actual.reason) return part.actual.reason;
  if (part.converged || !part.deviation_since_at) return "";
  const since = duration(now - Date.parse(part.deviation_since_at));
  if (part.change) return `changing for ${since}`;
  // What a part itself deviates from is on its pills; which of its parts deviates is not.
  const elsewhere = part.deviation_reason;
  const isOwn = !elsewhere || elsewhere.startsWith(`${part.name} is `);
  return isOwn ? `deviating for ${since}` : `deviating for ${since}: ${elsewhere}`;
}

customElements.define("ph-part-tree", PartTree);
