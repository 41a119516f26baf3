/** <ph-error-list>: the errors of the selected part that are on, each with its time.
 *
 * That it deviates is told by its pills, and why below them.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { duration } from "/web/js/base/words.js";

class ErrorList extends HTMLElement {
  #lines = new Map();

  connectedCallback() {
    this.list ??= el("ul", { class: "part-errors", "aria-label": "Errors of this part" });
    this.append(this.list);
  }

  /** Show the errors; an element stays while its error does, so that a reader is not disturbed. */
  show({ errors: all, knownAt }) {
    const errors = all.filter(({ error }) => error !== "DEVIATES");
    setAttribute(this, "hidden", errors.length === 0);
    const wanted = new Set(errors.map(({ error }) => error));
    for (const [error, line] of this.#lines) {
      if (wanted.has(error)) continue;
      line.item.remove();
      this.#lines.delete(error);
    }
    for (const { error, message, since_at } of errors) {
      if (!this.#lines.has(error)) this.#add(error);
      const line = this.#lines.get(error);
      setText(line.message, message);
      setAttribute(line.item, "title", message);
      setText(line.since, `for ${duration(knownAt - Date.parse(since_at))}`);
    }
  }

  #add(error) {
    const [message, since] = [el("span"), el("span", { class: "quiet" })];
    const item = el("li", {}, el("strong", {}, `⚠ ${error}`), " ", since, " ", message);
    this.list.append(item);
    this.#lines.set(error, { item, message, since });
  }
}

customElements.define("ph-error-list", ErrorList);
