/** <ph-hold-chips>: the first holds that a person may release, by a long press; a count opens all. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { wholeSeconds } from "/web/js/base/words.js";
import { holdKey, isReleasable, releaseHold, whoseWords } from "/web/js/header/release.js";
import "/web/js/header/hold_list.js";

const SHOWN = 2;

class HoldChips extends HTMLElement {
  #chips = new Map();

  connectedCallback() {
    this.list = el("ul", { class: "chips-holds", "aria-label": "Holds" });
    this.count = el("button", { type: "button", class: "chip held-count", "data-level": "attention", hidden: true });
    this.all = el("div", { popover: "auto", class: "sheet", role: "dialog", "aria-label": "Holds" });
    this.every = el("ph-hold-list");
    this.all.append(el("h2", {}, "Holds"), this.every);
    this.count.addEventListener("click", () => this.all.togglePopover());
    this.problem = el("span", { class: "chip", role: "alert", "data-level": "attention", hidden: true });
    this.append(this.problem, this.list, this.count);
    // Not within the header, whose ground and text have the colours of the level.
    document.body.append(this.all);
  }

  show({ live, contact, knownAt, volatile }) {
    const holds = Object.values(live.holds);
    const enabled = contact.level !== "lost" && !live.replay;
    const mine = holds.filter(isReleasable);
    const first = new Map(mine.slice(0, SHOWN).map((hold) => [holdKey(hold), hold]));
    for (const [key, chip] of this.#chips) {
      if (first.has(key)) continue;
      chip.item.remove();
      this.#complain("");
      this.#chips.delete(key);
    }
    // A chip stays as it is while only its reason changes, so that a press on it goes on.
    for (const [key, hold] of first) {
      if (!this.#chips.has(key)) this.#chips.set(key, this.#add(hold));
      this.#draw(this.#chips.get(key), hold, { enabled, knownAt, volatile });
    }
    setAttribute(this.count, "hidden", holds.length === 0);
    setAttribute(this.count, "data-more", holds.length - first.size);
    setText(this.count, holds.length === 1 ? "1 hold" : `${holds.length} holds`);
    const isOpen = this.all.matches(":popover-open");
    if (isOpen && holds.length === 0) this.all.hidePopover();
    if (isOpen || this.seen !== live.holds) this.every.show({ holds, enabled, knownAt, volatile });
    this.seen = live.holds;
  }

  #add(hold) {
    const why = el("span", { class: "why-held" });
    const item = el("li", { class: "chip hold" }, el("strong", {}, hold.owner), why);
    this.list.append(item);
    const release = el("ph-hold-button", { label: `Release ${hold.owner} (hold)`, short: "Release" });
    release.addEventListener("ph-held", ({ detail }) =>
      whileSending(release.button, async () => {
        this.#complain(await releaseHold(hold.owner, detail.volatile));
      }),
    );
    item.append(release);
    return { item, why, release };
  }

  #complain(text) {
    setText(this.problem, text);
    setAttribute(this.problem, "title", text);
    setAttribute(this.problem, "hidden", text === "");
  }

  #draw({ item, why, release }, hold, { enabled, knownAt, volatile }) {
    const since = `for ${wholeSeconds(knownAt - Date.parse(hold.since_at))}`;
    setText(why, hold.reason || since);
    setAttribute(item, "title", [hold.owner, hold.reason, since, whoseWords(hold)].filter(Boolean).join(", "));
    release.disabled = !enabled;
    release.volatile = volatile;
  }
}

customElements.define("ph-hold-chips", HoldChips);
