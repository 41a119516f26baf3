/** <ph-hold-list>: the holds that keep the vehicle from driving, with buttons to release them.
 *
 * Without the last one the robot drives, so releasing needs a long press. Dispatches `ph-release`
 * with `{owner, button, volatile}`.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { wholeSeconds } from "/web/js/base/words.js";

class HoldList extends HTMLElement {
  #lines = new Map();

  connectedCallback() {
    if (this.list) return;
    this.list = el("ul", { class: "holds", "aria-label": "Holds" });
    this.append(el("h3", {}, "Held by"), this.list);
  }

  show({ holds, enabled, knownAt, volatile }) {
    setAttribute(this, "hidden", holds.length === 0);
    const wanted = new Set(holds.map(keyOf));
    for (const [key, line] of this.#lines) {
      if (wanted.has(key)) continue;
      line.item.remove();
      this.#lines.delete(key);
    }
    // A line stays as it is while only its reason changes, so that a press on it goes on.
    for (const hold of holds) {
      if (!this.#lines.has(keyOf(hold))) this.#add(hold);
      const { reason, since, release } = this.#lines.get(keyOf(hold));
      setText(reason, hold.reason ? `: ${hold.reason}` : "");
      setText(since, `for ${wholeSeconds(knownAt - Date.parse(hold.since_at))}`);
      if (!release) continue;
      release.disabled = !enabled;
      release.volatile = volatile;
    }
  }

  #add(hold) {
    const { owner, by } = hold;
    const [reason, since] = [el("span"), el("span", { class: "quiet" })];
    // Pilothouse clears its own holds when their cause is gone, but for the one of a restart.
    const isOfReaction = owner.startsWith("reaction:");
    const release = !(owner in UNTIL) && !isOfReaction ? el("ph-hold-button", { label: `Release ${owner} (hold)` }) : null;
    release?.addEventListener("ph-held", ({ detail: { volatile } }) => {
      const detail = { owner, button: release.button, volatile };
      this.dispatchEvent(new CustomEvent("ph-release", { bubbles: true, detail }));
    });
    const whose = by ? (by === owner ? "" : `, by ${by}`) : (isOfReaction ? ", until that is over" : OWN[owner] ?? "");
    const words = el("div", {}, el("strong", {}, owner), reason, el("p", { class: "quiet" }, since, whose));
    const item = el("li", {}, words, release);
    this.list.append(item);
    this.#lines.set(keyOf(hold), { item, reason, since, release });
  }
}

/** What ends the holds that Pilothouse releases itself. */
const UNTIL = {
  error: ", until the errors end",
  vehicle: ", until there is a pose",
  drive_process: ", until the vehicle can be commanded",
};

const OWN = { ...UNTIL, restart: ", by Pilothouse" };

function keyOf({ owner, by, since_at }) {
  return JSON.stringify([owner, by, since_at]);
}

customElements.define("ph-hold-list", HoldList);
