/** <ph-chips>: beside the sentence: holds, parts that need attention, what is not real, contact. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { partCounts } from "/web/js/base/part_problems.js";
import { wholeSeconds } from "/web/js/base/words.js";
import "/web/js/header/hold_chips.js";

const UNSTORED_MS = 5000;

class Chips extends HTMLElement {
  #unstoredAt = -Infinity;

  connectedCallback() {
    this.holds = el("ph-hold-chips");
    this.deviating = this.#attention("deviating");
    this.unreachable = this.#attention("unreachable");
    this.unreal = el("span", { class: "chip badge", hidden: true });
    this.contact = el("span");
    this.delay = el("span", { class: "quiet" });
    this.tryNow = el("button", { type: "button", class: "small", hidden: true }, "Try now");
    this.tryNow.addEventListener("click", () => this.#tell("ph-try-now"));
    this.unstored = el("span", { class: "chip", role: "status", hidden: true });
    document.addEventListener("ph-unstored", () => (this.#unstoredAt = performance.now()));
    const contact = el("span", { class: "chip contact" }, this.contact, this.delay);
    this.append(this.tryNow, this.unstored, this.holds, this.deviating, this.unreachable, this.unreal, contact);
    this.whole = contact;
  }

  #attention(kind) {
    const button = el("button", { type: "button", class: "chip", "data-level": "attention", "data-kind": kind });
    button.addEventListener("click", () => this.#tell("ph-attention"));
    button.hidden = true;
    return button;
  }

  #tell(name) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true }));
  }

  show(view) {
    const { live, contact } = view;
    this.holds.show(view);
    this.#showParts(live.parts);
    this.#showUnreal(live);
    this.#showContact(contact);
    const isUnstored = performance.now() - this.#unstoredAt < UNSTORED_MS;
    setAttribute(this.unstored, "hidden", !isUnstored);
    setText(this.unstored, isUnstored ? "Done; not on disk yet" : "");
  }

  #showParts(parts) {
    if (this.parts === parts) return;
    this.parts = parts;
    const { total, deviating, unreachable } = partCounts(parts);
    setAttribute(this.deviating, "hidden", deviating === 0);
    setText(this.deviating, `${deviating} of ${total} ${deviating === 1 ? "deviates" : "deviate"}`);
    setAttribute(this.unreachable, "hidden", unreachable === 0);
    setText(this.unreachable, `${unreachable} unreachable`);
  }

  #showUnreal({ replay, systemState }) {
    const simulated = systemState?.simulated ?? [];
    setAttribute(this.unreal, "hidden", !replay && simulated.length === 0);
    this.unreal.classList.toggle("replay", Boolean(replay));
    setText(this.unreal, replay ? "REPLAY" : "SIMULATED");
    const what = replay ? `Recording of ${replay.robot}` : `Simulated: ${simulated.join(", ")}`;
    setAttribute(this.unreal, "title", what);
  }

  #showContact(contact) {
    const { level, roundTripMs, skipped, retryInMs } = contact;
    setText(this.contact, contactWords(contact));
    const isKnown = level === "live" && roundTripMs !== null;
    const lost = skipped === 1 ? "1 frame skipped" : `${skipped} frames skipped`;
    const trip = isKnown ? `${Math.max(1, Math.round(roundTripMs))} ms` : "";
    const missed = level === "live" && skipped > 0 ? `${skipped} skipped` : "";
    setText(this.delay, [trip, missed].filter(Boolean).join(" · "));
    setAttribute(this.whole, "title", `${isKnown ? `Round trip ${trip}; ` : ""}${lost} since the page was opened`);
    setAttribute(this.tryNow, "hidden", retryInMs === null || level === "live");
  }
}

function contactWords({ level, silenceMs, retryInMs }) {
  if (level === "live") return "Connected";
  const late = level === "late" ? `Late: last values ${wholeSeconds(silenceMs)} ago. ` : "";
  if (retryInMs === null) return `${late}Connecting …`;
  return `${late}Next attempt in ${Math.ceil(retryInMs / 1000)} s`;
}

customElements.define("ph-chips", Chips);
