/** <ph-stop-release>: a band while the emergency stop is engaged: who engaged it, and its release. */

import { request } from "/web/js/base/api.js";
import { notStoppedWords, stopPlaces } from "/web/js/base/device_words.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { standstillWords } from "/web/js/base/state_sentence.js";
import { timeOfDay } from "/web/js/base/words.js";
import { drawSteps } from "/web/js/header/stop_steps.js";

/** A release waits up to 2 s for the disk before it is carried out, and as long for its outcome. */
const RELEASED_MS = 8000;
const NO_REASON = "released on the monitor page";

class StopRelease extends HTMLElement {
  connectedCallback() {
    this.className = "band";
    this.what = el("strong");
    this.stands = el("span");
    this.unheard = el("strong", { class: "unheard" });
    this.steps = el("ol", { class: "stop-steps narrow-only", "aria-label": "Emergency stop" });
    this.reason = el("input", { type: "text", maxlength: 200, placeholder: "Reason, optional", "aria-label": "Reason for the release" });
    this.release = el("ph-hold-button", { label: "Release the stop (hold)" });
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.append(el("p", { class: "grow" }, this.what, this.stands, this.unheard), this.steps, this.reason, this.release, this.problem);
    this.release.addEventListener("ph-held", ({ detail }) => this.#release(detail.volatile));
  }

  update({ live, contact, volatile, stopProgress }) {
    const latch = live.emergencyStop;
    setAttribute(this, "hidden", !latch?.engaged);
    if (!latch?.engaged) return this.#say("");
    const where = stopPlaces(latch);
    const by = latch.by ? ` by ${latch.by}` : "";
    const why = latch.reason ? `: ${latch.reason}` : "";
    const when = latch.since_at ? ` at ${timeOfDay(latch.since_at)}` : "";
    setText(this.what, `Emergency stop engaged${where && ` ${where}`}${when}${by}${why}`);
    setText(this.stands, contact.level === "lost" ? "" : `; ${standstillWords(live)}`);
    const away = notStoppedWords(live.devices);
    setText(this.unheard, away && `; ${away}`);
    drawSteps(this.steps, stopProgress);
    this.stops = latch.stops;
    this.release.disabled = contact.level === "lost" || Boolean(live.replay);
    this.release.volatile = volatile;
  }

  #release(volatile) {
    // What came meanwhile, nobody saw.
    const stops = this.stops?.map(({ id }) => id);
    const body = { engaged: false, reason: this.reason.value.trim() || NO_REASON, stops };
    if (volatile) body.volatile = true;
    return whileSending(this.release.button, async () => {
      let said = "";
      try {
        const detail = await request("PUT", "/emergency_stop", body, { keepalive: true, timeoutMs: RELEASED_MS });
        this.reason.value = "";
        this.dispatchEvent(new CustomEvent("ph-latch", { bubbles: true, detail }));
        const silent = detail.stops?.filter(({ device }) => detail.not_heard.includes(device));
        if (silent?.length > 0) said = `Still engaged ${stopPlaces({ ...detail, stops: silent })}. Release it there.`;
      } catch ({ message }) {
        said = `Not released: ${message}`;
      }
      this.#say(said);
    });
  }

  #say(problem) {
    setText(this.problem, problem);
    setAttribute(this.problem, "hidden", problem === "");
  }
}

customElements.define("ph-stop-release", StopRelease);
