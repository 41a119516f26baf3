/** <ph-part-why>: why a part is not where it should be; the reasons are asked for while it is open.
 *
 * Dispatches `ph-explain` when it is opened or closed.
 */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { reasonTree } from "/web/js/base/reasons.js";
import { plainMessage } from "/web/js/base/signal_words.js";
import { label } from "/web/js/base/words.js";

class PartWhy extends HTMLElement {
  connectedCallback() {
    if (this.details) return;
    this.where = el("p", { class: "facts" });
    this.reasons = el("div");
    this.details = el("details", { class: "unfold" });
    this.summary = el("summary");
    this.details.append(this.summary, this.where, this.reasons);
    this.details.addEventListener("toggle", () =>
      this.dispatchEvent(new CustomEvent("ph-explain", { bubbles: true })),
    );
    this.append(this.details);
  }

  get isOpen() {
    return this.details.open && !this.hidden;
  }

  /** Show the answer to `GET P/why` for a part; null: it is not there yet. */
  show({ part, why, signals }) {
    const target = part.effective_target;
    const isDisplaced = Boolean(target && target.because !== "requested");
    setAttribute(this, "hidden", part.converged && !isDisplaced);
    setText(this.summary, part.converged ? "Why this target" : "Why it deviates");
    setText(this.where, isDisplaced ? displacedWords(part, target) : "");
    renderOnce(this.reasons, JSON.stringify(why?.blockers), () => {
      if (!why?.blockers) return [el("p", { class: "quiet" }, "Asking …")];
      if (why.blockers.length === 0) return [el("p", { class: "quiet" }, "No reason is known.")];
      return [reasonTree(why.blockers, (text) => plainMessage(text, signals))];
    });
  }
}

/** Kinds of setters that have a name, where that of the interface says too little. */
const KINDS = { local: "the device by its reaction" };
const SETTERS = { invariant: "a broken invariant", reaction: "a reaction" };

function displacedWords({ target: requested }, target) {
  const name = target.rule ?? target.reaction;
  const because = name ? `${KINDS[target.because] ?? target.because} ${name}` : (SETTERS[target.because] ?? target.because);
  const from = requested ? `, in place of ${label(requested)} that was requested` : "";
  return `Target ${label(target)}, set by ${because}${from}.`;
}

customElements.define("ph-part-why", PartWhy);
