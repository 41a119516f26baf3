/** <ph-alarm>: one error with what follows from it, and what can be done about its announcing.
 *
 * Dispatches `ph-select` with the name of its part.
 */

import { request, partPath } from "/web/js/base/api.js";
import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { errorName, isOn, mayGoOn, worseBelow } from "/web/js/base/error_groups.js";
import { whileSending } from "/web/js/base/sending.js";
import { duration, timeAndDay } from "/web/js/base/words.js";
import "/web/js/inspector/shelve_form.js";

const BELOW_SHOWN = 20;

class Alarm extends HTMLElement {
  #path = "";

  connectedCallback() {
    if (this.head) return;
    this.name = el("strong", { class: "alarm-name" });
    this.link = el("button", { type: "button", class: "link alarm-name" });
    this.link.addEventListener("click", () =>
      this.dispatchEvent(new CustomEvent("ph-select", { bubbles: true, detail: this.partName })),
    );
    this.severity = el("span", { class: "severity" });
    this.head = el("p", { class: "alarm-head" }, this.name, this.link, this.severity);
    this.message = el("p", { class: "alarm-message" });
    this.facts = el("p", { class: "quiet" });
    this.advice = el("p", { class: "hint" });
    this.list = el("ul");
    this.summary = el("summary");
    this.below = el("details", { class: "reasons-of", hidden: true }, this.summary, this.list);
    this.held = el("ph-hold-button", { label: "Acknowledge (hold)", hidden: true });
    this.held.addEventListener("ph-held", ({ detail }) => this.#acknowledge(this.held.button, detail));
    this.seen = el("button", { type: "button", class: "small" }, "Acknowledge");
    this.seen.addEventListener("click", () => this.#acknowledge(this.seen, {}));
    this.shelve = el("button", { type: "button", class: "small", "aria-expanded": "false" }, "Shelve …");
    this.shelve.addEventListener("click", () => this.#toggleForm());
    this.announce = el("button", { type: "button", class: "small" }, "Announce again");
    this.announce.addEventListener("click", () => this.#send(this.announce, "DELETE", "/shelf"));
    this.form = el("ph-shelve-form", { hidden: true });
    this.form.addEventListener("ph-shelve", ({ detail }) => this.#shelve(detail));
    this.form.addEventListener("ph-cancel", () => this.#toggleForm());
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.append(
      this.head,
      this.message,
      this.facts,
      this.advice,
      this.below,
      el("div", { class: "buttons" }, this.held, this.seen, this.shelve, this.announce),
      this.form,
      this.problem,
    );
  }

  /** Show an error.
   *
   * `below` follows from it, `part` is its part as in frames; undefined: the robot itself.
   */
  show({ error, below, part, enabled, knownAt, volatile }) {
    this.partName = error.part;
    this.#path = `${part ? partPath(part) : ""}/errors/${encodeURIComponent(error.error)}`;
    setAttribute(this, "data-state", error.state);
    setAttribute(this, "data-severity", error.severity);
    const isOfPart = error.part !== null;
    setText(isOfPart ? this.link : this.name, errorName(error));
    setAttribute(this.name, "hidden", isOfPart);
    setAttribute(this.link, "hidden", !isOfPart);
    setText(this.severity, [error.severity, error.first_out ? "first" : ""].filter(Boolean).join(", "));
    setText(this.message, error.message);
    setAttribute(this.message, "hidden", error.message === "");
    setText(this.facts, factsOf(error, knownAt));
    setText(this.advice, error.hint ?? "");
    setAttribute(this.advice, "hidden", !error.hint);
    this.#showBelow(error, below);
    this.#showButtons(error, enabled, volatile);
  }

  #showBelow(error, below) {
    setAttribute(this.below, "hidden", below.length === 0);
    const worse = worseBelow(error, below);
    const leadsTo = worse ? `: ${errorName(worse)}, ${worse.severity}` : "";
    setText(this.summary, `${below.length} ${below.length === 1 ? "follows" : "follow"} from this${leadsTo}`);
    const shown = below.slice(0, BELOW_SHOWN).map((error) => [errorName(error), error.message, error.state]);
    renderOnce(this.list, JSON.stringify([shown, below.length]), () => [
      ...shown.map(([name, message, state]) =>
        el("li", { "data-state": state }, el("strong", {}, name), message ? `: ${message}` : ""),
      ),
      ...(below.length > BELOW_SHOWN ? [el("li", { class: "quiet" }, `and ${below.length - BELOW_SHOWN} more`)] : []),
    ]);
  }

  #showButtons(error, enabled, volatile) {
    const { state, shelved_until_at: until } = error;
    const isWaiting = ["active", "latched", "returned"].includes(state);
    const needsHold = mayGoOn(error);
    setAttribute(this.held, "hidden", !(isWaiting && needsHold));
    this.held.disabled = !enabled;
    this.held.volatile = volatile;
    setAttribute(this.seen, "hidden", !isWaiting || needsHold);
    setAttribute(this.shelve, "hidden", until !== null || (!isOn(error) && !error.chattering));
    setAttribute(this.announce, "hidden", until === null);
    for (const button of [this.seen, this.shelve, this.announce]) setAttribute(button, "disabled", !enabled);
    if (until !== null && !this.form.hidden) this.#toggleForm();
    this.form.enabled = enabled;
  }

  #toggleForm() {
    const isOpen = this.form.hidden;
    setAttribute(this.form, "hidden", !isOpen);
    setAttribute(this.shelve, "aria-expanded", String(isOpen));
    if (isOpen) this.form.begin();
    else this.shelve.focus();
  }

  #acknowledge(button, { volatile }) {
    return this.#send(button, "POST", volatile ? "/acknowledge?volatile=true" : "/acknowledge");
  }

  #shelve({ button, for_s, reason }) {
    return this.#send(button, "PUT", "/shelf", { for_s, reason });
  }

  #send(button, method, what, body) {
    return whileSending(button, async () => {
      let said = "";
      try {
        await request(method, this.#path + what, body);
      } catch ({ message }) {
        said = `Not done: ${message}`;
      }
      setText(this.problem, said);
      setAttribute(this.problem, "hidden", said === "");
    });
  }
}

const OVER = {
  latched: "its cause is gone; it waits for you",
  acknowledged: "acknowledged",
  returned: "it is over",
};

function factsOf(error, knownAt) {
  const { state, since_at: since, ended_at: ended, count } = error;
  const facts = [OVER[state] ?? ""];
  if (isOn(error)) facts.push(`for ${duration(knownAt - Date.parse(since))}`);
  if (state === "returned" && since) {
    const lasted = ended ? `, for ${duration(Date.parse(ended) - Date.parse(since))}` : "";
    facts.push(`from ${timeAndDay(since)}${lasted}`);
  }
  if (count > 1) facts.push(`${count} times`);
  if (error.shelved_until_at !== null) {
    facts.push(`shelved until ${timeAndDay(error.shelved_until_at)}: ${error.shelved_because}`);
  }
  if (error.suppressed) facts.push("silenced by the model");
  return facts.filter(Boolean).join(" · ");
}

customElements.define("ph-alarm", Alarm);
