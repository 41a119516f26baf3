/** <ph-hold-list>: all holds that keep the vehicle from driving, with why, for how long, by whom.
 *
 * Without the last one the robot drives, so releasing needs a long press.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { wholeSeconds } from "/web/js/base/words.js";
import { holdKey, isReleasable, releaseHold, whoseWords } from "/web/js/header/release.js";

class HoldList extends HTMLElement {
  #lines = new Map();

  connectedCallback() {
    if (this.list) return;
    this.list = el("ul", { class: "holds", "aria-label": "Holds" });
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.append(this.list, this.problem);
  }

  update({ live, contact, knownAt, volatile }) {
    const holds = Object.values(live.holds);
    setAttribute(this.closest("section"), "hidden", holds.length === 0);
    this.show({ holds, enabled: contact.level !== "lost" && !live.replay, knownAt, volatile });
  }

  show({ holds, enabled, knownAt, volatile }) {
    setAttribute(this, "hidden", holds.length === 0);
    const wanted = new Set(holds.map(holdKey));
    for (const [key, line] of this.#lines) {
      if (wanted.has(key)) continue;
      line.item.remove();
      this.#lines.delete(key);
      this.#complain("");
    }
    // A line stays as it is while only its reason changes, so that a press on it goes on.
    for (const hold of holds) {
      if (!this.#lines.has(holdKey(hold))) this.#add(hold);
      const { reason, since, release } = this.#lines.get(holdKey(hold));
      setText(reason, hold.reason ? `: ${hold.reason}` : "");
      const whose = whoseWords(hold);
      setText(since, `for ${wholeSeconds(knownAt - Date.parse(hold.since_at))}${whose && `, ${whose}`}`);
      if (!release) continue;
      release.disabled = !enabled;
      release.volatile = volatile;
    }
  }

  #add(hold) {
    const { owner } = hold;
    const [reason, since] = [el("span"), el("p", { class: "quiet" })];
    const release = isReleasable(hold) ? el("ph-hold-button", { label: `Release ${owner} (hold)` }) : null;
    release?.addEventListener("ph-held", ({ detail: { volatile } }) =>
      whileSending(release.button, async () => this.#complain(await releaseHold(owner, volatile))),
    );
    const item = el("li", {}, el("div", {}, el("strong", {}, owner), reason, since), release);
    this.list.append(item);
    this.#lines.set(holdKey(hold), { item, reason, since, release });
  }

  #complain(text) {
    setText(this.problem, text);
    setAttribute(this.problem, "hidden", text === "");
  }
}

customElements.define("ph-hold-list", HoldList);
