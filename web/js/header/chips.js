/** <ph-chips>: beside the sentence: holds, parts that need attention, other computers, what is not real,
 * contact.
 */

import { amiss, chipWords, ownWords } from "/web/js/base/device_words.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { partCounts } from "/web/js/base/part_problems.js";
import { wholeSeconds } from "/web/js/base/words.js";
import "/web/js/header/hold_chips.js";

const UNSTORED_MS = 5000;
/** As many devices have a chip of their own. */
const SHOWN = 2;

class Chips extends HTMLElement {
  #unstoredAt = -Infinity;

  connectedCallback() {
    this.holds = el("ph-hold-chips");
    this.deviating = this.#attention("deviating");
    this.unreachable = this.#attention("unreachable");
    this.devices = el("span", { class: "chips-devices" });
    this.ownText = el("span");
    // On a phone it is wider than the header: whoever has keys only can scroll to what is behind it.
    this.own = el("span", { class: "chip badge", hidden: true, tabindex: 0 }, el("span", { class: "more-word" }, "DEVICE "), this.ownText);
    this.unreal = el("span", { class: "chip badge", hidden: true });
    this.contact = el("span");
    this.delay = el("span", { class: "quiet" });
    this.tryNow = el("button", { type: "button", class: "small", hidden: true }, "Try now");
    this.tryNow.addEventListener("click", () => this.#tell("ph-try-now"));
    this.unstored = el("span", { class: "chip", role: "status", hidden: true });
    document.addEventListener("ph-unstored", () => (this.#unstoredAt = performance.now()));
    const contact = el("span", { class: "chip contact" }, this.contact, this.delay);
    this.append(this.tryNow, this.unstored, this.holds, this.devices, this.deviating, this.unreachable, this.own, this.unreal, contact);
    this.whole = contact;
  }

  #attention(kind, ...words) {
    const button = el("button", { type: "button", class: "chip", "data-level": "attention", "data-kind": kind }, ...words);
    button.addEventListener("click", () => this.#tell("ph-attention"));
    button.hidden = words.length === 0;
    return button;
  }

  #tell(name) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true }));
  }

  show(view) {
    const { live, contact } = view;
    this.holds.show(view);
    this.#showDevices(live);
    this.#showParts(live);
    this.#showUnreal(live);
    this.#showContact(contact);
    const isUnstored = performance.now() - this.#unstoredAt < UNSTORED_MS;
    setAttribute(this.unstored, "hidden", !isUnstored);
    setText(this.unstored, isUnstored ? "Done; not on disk yet" : "");
  }

  #showDevices({ devices, ownDevice }) {
    const away = amiss(devices);
    const words = away.slice(0, SHOWN).map(chipWords);
    const left = away.slice(SHOWN).map((device) => chipWords(device).text);
    if (left.length > 0) words.push({ text: `${left.length} more devices`, title: left.join(", ") });
    renderOnce(this.devices, JSON.stringify(words), () =>
      words.map(({ text, title }) => {
        const chip = this.#attention("device", text);
        setAttribute(chip, "title", title);
        return chip;
      }),
    );
    setAttribute(this.own, "hidden", ownDevice === null);
    if (ownDevice === null) return;
    setText(this.ownText, ownWords(ownDevice));
    setAttribute(this.own, "title", [ownDevice.reason, `When cut off ${ownDevice.when_cut_off}`].filter(Boolean).join("; "));
    setAttribute(this.own, "data-level", ownDevice.lead === "supervisor" ? null : "attention");
  }

  #showParts({ parts, devices }) {
    if (this.parts === parts) return;
    this.parts = parts;
    const { total, deviating, unreachable } = partCounts(parts, devices);
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
