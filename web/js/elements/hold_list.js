/** <ph-hold-list>: the holds that keep the vehicle from driving, with buttons to release them.
 *
 * Dispatches `ph-release` with the owner.
 */

import { el, renderOnce, setAttribute, setText } from "/web/js/dom.js";
import { wholeSeconds } from "/web/js/words.js";

class HoldList extends HTMLElement {
  connectedCallback() {
    if (this.list) return;
    this.list = el("ul", { class: "holds", "aria-label": "Holds" });
    this.append(el("h3", {}, "Held by"), this.list);
  }

  show({ holds, enabled, knownAt }) {
    setAttribute(this, "hidden", holds.length === 0);
    renderOnce(this.list, JSON.stringify(holds), () => holds.map((hold) => this.#line(hold)));
    for (const line of this.list.children) {
      setText(line.since, `for ${wholeSeconds(knownAt - Date.parse(line.hold.since_at))}`);
      if (line.release) setAttribute(line.release, "disabled", !enabled);
    }
  }

  #line(hold) {
    const { owner, reason, by } = hold;
    const since = el("span", { class: "quiet" });
    const ask = () =>
      this.dispatchEvent(new CustomEvent("ph-release", { bubbles: true, detail: owner }));
    const name = `Release the hold ${owner}`;
    // Pilothouse clears its own holds when their cause is gone.
    const release = by
      ? el("button", { type: "button", "aria-label": name, onclick: ask }, "Release")
      : null;
    const whose = by ? (by === owner ? "" : `, by ${by}`) : ", cleared automatically";
    const line = el(
      "li",
      {},
      el(
        "div",
        {},
        el("strong", {}, owner),
        el("span", {}, reason ? `: ${reason}` : ""),
        el("p", { class: "quiet" }, since, whose),
      ),
      release,
    );
    return Object.assign(line, { hold, since, release });
  }
}

customElements.define("ph-hold-list", HoldList);
