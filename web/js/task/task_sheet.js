/** <ph-task-sheet>: the form for a new task, beside the map on which its path is seen first.
 *
 * It covers no other part of the page: STOP and the task that runs stay within reach. Dispatches
 * `ph-closed`.
 */

import { el } from "/web/js/base/dom.js";
import "/web/js/task/task_form.js";

class TaskSheet extends HTMLElement {
  connectedCallback() {
    if (this.form) return;
    const close = { type: "button", class: "sheet-close", "aria-label": "Close", title: "Close" };
    this.form = el("ph-task-form", { "onph-started": () => this.close() });
    this.tabIndex = -1;
    this.setAttribute("role", "dialog");
    this.setAttribute("aria-label", "New task");
    this.append(
      el(
        "div",
        { class: "sheet-head" },
        el("h2", {}, "New task"),
        el("button", { ...close, onclick: () => this.close() }, "×"),
      ),
      this.form,
    );
    this.addEventListener("keydown", (event) => {
      if (event.key !== "Escape") return;
      event.stopPropagation();
      this.close();
    });
  }

  get isOpen() {
    return !this.hidden;
  }

  /** Show the form, with a file that was dropped; on a phone the map comes into view for it. */
  async open(view, file = null) {
    this.hidden = false;
    this.dispatchEvent(new CustomEvent("ph-tab", { bubbles: true, detail: "map" }));
    this.show(view);
    this.focus();
    await this.form.load();
    if (file) this.form.take(file);
  }

  close() {
    this.hidden = true;
    this.form.discard();
    this.dispatchEvent(new CustomEvent("ph-closed"));
  }

  show({ state, enabled }) {
    if (this.isOpen) this.form.show(state, enabled);
  }
}

customElements.define("ph-task-sheet", TaskSheet);
