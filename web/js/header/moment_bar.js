/** <ph-moment-bar>: says that the panels show a moment of before, while header and STOP are live. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { timeAndDay } from "/web/js/base/words.js";

class MomentBar extends HTMLElement {
  connectedCallback() {
    this.className = "band";
    this.when = el("span", { class: "grow", role: "status" });
    const back = el("button", { type: "button", "aria-keyshortcuts": "Escape", title: "Esc" }, "Back to live");
    back.addEventListener("click", () => {
      this.dispatchEvent(new CustomEvent("ph-moment", { bubbles: true, detail: null }));
    });
    this.append(this.when, back);
  }

  update({ moment }) {
    setAttribute(this, "hidden", moment === null);
    document.body.toggleAttribute("data-moment", moment !== null);
    setText(this.when, moment ? `Panels show ${timeAndDay(moment.at)}; the header and STOP stay live.` : "");
  }
}

customElements.define("ph-moment-bar", MomentBar);
