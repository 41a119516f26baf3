/** What is under the pointer or the cursor, in a box beside it. */

import { el, setText } from "/web/js/base/dom.js";
import { clockWords, markWords, momentWords } from "/web/js/timeline/describe.js";

const AWAY_PX = 14;
const WIDTH_PX = 280;

export class Tip {
  constructor() {
    this.when = el("span", { class: "tip-when" });
    this.title = el("strong");
    this.lines = el("span", { class: "tip-lines" });
    this.root = el("div", { class: "tip", popover: "manual", "aria-hidden": "true" }, this.when, this.title, this.lines);
  }

  /** What it says, in one line; empty while it is hidden. */
  get text() {
    const parts = [this.when, this.title, this.lines].map(({ textContent }) => textContent);
    return this.isShown ? parts.filter(Boolean).join(", ") : "";
  }

  /** Show what `found` is (see `LanesView.at`), beside a place of the window. */
  show({ at, lane, items }, dark, now, x, y) {
    const gap = dark.find(({ begin, end }) => begin < at && at < end);
    setText(this.when, clockWords(at));
    setText(this.title, "");
    setText(this.lines, "");
    if (lane) {
      const { title, lines } = gap
        ? { title: gap.text, lines: [] }
        : items.length
          ? markWords(lane, items, now)
          : { title: momentWords(lane, at), lines: [] };
      setText(this.when, `${clockWords(at)} · ${lane.name}`);
      setText(this.title, title);
      setText(this.lines, lines.join("\n"));
    }
    this.#place(x, y);
  }

  hide() {
    if (!this.isShown) return;
    this.isShown = false;
    this.root.hidePopover();
  }

  #place(x, y) {
    const { style } = this.root;
    style.left = `${Math.max(8, Math.min(x - WIDTH_PX / 2, innerWidth - WIDTH_PX - 8))}px`;
    style.bottom = `${innerHeight - y + AWAY_PX}px`;
    if (!this.isShown) this.root.showPopover();
    this.isShown = true;
  }
}
