/** <ph-shelve-form>: for how long an error is shelved, and why.
 *
 * Dispatches `ph-shelve` with `{for_s, reason, button}`, and `ph-cancel`.
 */

import { el, setAttribute, setText } from "/web/js/base/dom.js";

const TIMES = [
  [600, "10 min"],
  [1800, "30 min"],
  [3600, "1 h"],
  [4 * 3600, "4 h"],
  [8 * 3600, "8 h"],
];
const MAX_REASON = 500;

class ShelveForm extends HTMLElement {
  connectedCallback() {
    if (this.reason) return;
    this.time = el("select", {}, ...TIMES.map(([value, text]) => el("option", { value }, text)));
    this.reason = el("input", { type: "text", maxlength: MAX_REASON, placeholder: "what is being done about it" });
    this.button = el("button", { type: "submit", class: "small primary" }, "Shelve");
    const cancel = el("button", { type: "button", class: "small" }, "Cancel");
    cancel.addEventListener("click", () => this.#tell("ph-cancel"));
    this.missing = el("p", { class: "problem", role: "alert", hidden: true });
    const form = el(
      "form",
      {},
      el("label", { class: "field" }, el("span", { class: "quiet" }, "Reason"), this.reason),
      el("label", { class: "field" }, el("span", { class: "quiet" }, "For"), this.time),
      el("div", { class: "buttons" }, this.button, cancel),
      el("p", { class: "quiet" }, "It is not announced for that time. What it does to the robot stays."),
      this.missing,
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#submit();
    });
    this.append(form);
  }

  set enabled(value) {
    setAttribute(this.button, "disabled", !value);
  }

  /** Begin anew, with the reason before the eyes. */
  begin() {
    this.reason.value = "";
    setAttribute(this.missing, "hidden", true);
    this.reason.focus();
  }

  #submit() {
    const reason = this.reason.value.trim();
    setText(this.missing, reason ? "" : "Say why: whoever comes next has to know.");
    setAttribute(this.missing, "hidden", Boolean(reason));
    if (!reason) {
      this.reason.focus();
      return;
    }
    this.#tell("ph-shelve", { for_s: Number(this.time.value), reason, button: this.button });
  }

  #tell(name, detail) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true, detail }));
  }
}

customElements.define("ph-shelve-form", ShelveForm);
