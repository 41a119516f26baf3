/** <ph-replay-bar>: says that this is a recording, of what and when; pause, speed and time. */

import { request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { timeOfDay } from "/web/js/base/words.js";

const SPEEDS = [0.1, 0.5, 1, 2, 5, 10, 30, 100];
const PLACES = 1000;

class ReplayBar extends HTMLElement {
  #replay = null;
  #isDragging = false;

  connectedCallback() {
    this.what = el("strong");
    this.when = el("span");
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.pause = el("button", { type: "button", class: "small" });
    this.pause.addEventListener("click", () => this.#ask({ paused: !this.#replay.paused }));
    this.speed = el("select", { "aria-label": "Speed" });
    this.speed.addEventListener("change", () => this.#ask({ speed: Number(this.speed.value) }));
    this.place = el("input", { type: "range", min: 0, max: PLACES, "aria-label": "Time" });
    this.place.addEventListener("input", () => (this.#isDragging = true));
    this.place.addEventListener("change", () => this.#seek());
    this.append(
      el("p", { class: "replayed" }, this.what, this.when),
      el("div", { class: "player" }, this.pause, this.speed, this.place),
      this.problem,
    );
  }

  update({ state }) {
    const replay = state.replay;
    setAttribute(this, "hidden", !replay);
    document.body.toggleAttribute("data-replay", Boolean(replay));
    if (!replay) return;
    this.#replay = replay;
    setText(this.what, `REPLAY of ${replay.robot}`);
    const at = state.at ?? replay.at;
    setText(this.when, `, ${at.slice(0, 10)} ${timeOfDay(at)}, ×${replay.speed}${stand(replay, at)}`);
    setText(this.pause, replay.paused ? "Play" : "Pause");
    this.#offer(replay.speed);
    if (!this.#isDragging) this.place.value = placeOf(at, replay);
    if (replay.fault) this.#complain(`It cannot go on: ${replay.fault}`);
  }

  #offer(speed) {
    const speeds = [...new Set([...SPEEDS, speed])].sort((a, b) => a - b);
    const key = speeds.join();
    if (this.offered !== key) {
      this.offered = key;
      this.speed.replaceChildren(...speeds.map((one) => el("option", { value: one }, `×${one}`)));
    }
    if (document.activeElement !== this.speed) this.speed.value = String(speed);
  }

  async #seek() {
    const { from_at, to_at } = this.#replay;
    const [begin, end] = [Date.parse(from_at), Date.parse(to_at)];
    const at = new Date(begin + ((end - begin) * this.place.value) / PLACES).toISOString();
    // What is known of later is not true then: the page begins anew.
    if (await this.#ask({ at })) location.reload();
    this.#isDragging = false;
  }

  async #ask(wish) {
    try {
      const replay = await request("PUT", "/replay", wish, { timeoutMs: 60_000 });
      setAttribute(this.problem, "hidden", true);
      this.dispatchEvent(new CustomEvent("ph-replay", { bubbles: true, detail: replay }));
      return true;
    } catch (error) {
      this.#complain(error.message);
      return false;
    }
  }

  #complain(text) {
    setAttribute(this.problem, "hidden", false);
    setText(this.problem, text);
  }
}

function stand(replay, at) {
  if (replay.paused) return ", paused";
  return Date.parse(at) >= Date.parse(replay.to_at) ? ", at its end" : "";
}

function placeOf(at, { from_at, to_at }) {
  const [begin, end] = [Date.parse(from_at), Date.parse(to_at)];
  return end > begin ? Math.round(((Date.parse(at) - begin) / (end - begin)) * PLACES) : 0;
}

customElements.define("ph-replay-bar", ReplayBar);
