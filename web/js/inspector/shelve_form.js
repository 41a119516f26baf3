/** <ph-shelve-form>: why an error is shelved, and for how long.
 *
 * Dispatches `ph-shelve` with `{for_s, reason, button}`, and `ph-cancel`.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";

/** The first is sent by Enter. */
const TIMES = [
  [600, "10 min"],
  [3600, "1 h"],
  [8 * 3600, "8 h"],
];
const MAX_REASON = 500;

class ShelveForm extends HTMLElement {
  connectedCallback() {
    if (this.reason) return;
    this.reason = el("input", { type: "text", maxlength: MAX_REASON, placeholder: "what is being done about it" });
    this.times = TIMES.map(([for_s, text]) => el("button", { type: "submit", class: "small", value: for_s }, text));
    const cancel = el("button", { type: "button", class: "small" }, "Cancel");
    cancel.addEventListener("click", () => {
      this.close();
      this.#tell("ph-cancel");
    });
    this.missing = el("p", { class: "problem", role: "alert", hidden: true });
    const form = el(
      "form",
      { "aria-label": "Shelve" },
      el("label", { class: "field" }, el("span", {}, "Reason"), this.reason),
      this.missing,
      el("div", { class: "buttons" }, el("span", { class: "quiet" }, "Shelve for"), ...this.times, cancel),
      el("p", { class: "quiet" }, "It is not announced for that time. What it does to the robot stays."),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#submit(event.submitter ?? this.times[0]);
    });
    this.append(form);
  }

  set enabled(value) {
    for (const button of this.times) setAttribute(button, "disabled", !value);
  }

  /** Open it, with the reason before the eyes, or close it. */
  toggle() {
    if (!this.hidden) {
      this.close();
      return;
    }
    setAttribute(this, "hidden", false);
    this.reason.value = "";
    setAttribute(this.missing, "hidden", true);
    this.reason.focus();
  }

  close() {
    setAttribute(this, "hidden", true);
  }

  #submit(button) {
    const reason = this.reason.value.trim();
    setText(this.missing, reason ? "" : "Say why: whoever comes next has to know.");
    setAttribute(this.missing, "hidden", Boolean(reason));
    if (reason) this.#tell("ph-shelve", { for_s: Number(button.value), reason, button });
    else this.reason.focus();
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true, detail }));
  }
}

customElements.define("ph-shelve-form", ShelveForm);
