/** <ph-reason-list>: the sentence of the header in full, with the reasons that it has no room for. */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { stateSentence } from "/web/js/base/state_sentence.js";

class ReasonList extends HTMLElement {
  connectedCallback() {
    this.whole = el("p", { class: "whole" });
    this.list = el("ul", { class: "reasons", "aria-label": "Further reasons" });
    this.append(this.whole, this.list);
  }

  update({ live, state, contact }) {
    const said = stateSentence(state, state === live ? contact : { level: "live" });
    setAttribute(this, "hidden", said.level === "calm");
    setText(this.whole, `${said.word}: ${said.text}`);
    renderOnce(this.list, said.more.join("\n"), () => said.more.map((text) => el("li", {}, text)));
  }
}

customElements.define("ph-reason-list", ReasonList);
