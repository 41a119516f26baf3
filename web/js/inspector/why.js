/** <ph-why>: what is wrong with the robot, why, and what it does about it by itself.
 *
 * Errors and further reasons are one list, the worst first. Once somebody selected a part they are
 * closed, so that the part below is in sight; the event `ph-why` opens the first and goes there.
 */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { reasonTree } from "/web/js/base/reasons.js";
import "/web/js/inspector/alarm_list.js";
import "/web/js/inspector/reaction_list.js";

/** Nobody reads a list that changes faster. */
const PAUSE_MS = 200;

class Why extends HTMLElement {
  #seen = [];
  #shownAt = -Infinity;
  #isCompact = false;

  connectedCallback() {
    if (this.heading) return;
    this.count = el("span", { class: "quiet" });
    this.heading = el("h2", { tabindex: -1 }, "Why ", this.count);
    this.calm = el("p", { class: "quiet" });
    this.reasons = el("div");
    this.errors = el("ph-alarm-list");
    this.reactions = el("ph-reaction-list");
    const head = el("div", { class: "why-head" }, this.heading, this.calm);
    this.append(head, this.reasons, this.errors, this.reactions);
    document.addEventListener("ph-select", () => this.#fold(true));
    document.addEventListener("ph-why", () => this.#open());
  }

  update(view) {
    const { state, enabled, moment, knownAt, volatile } = view;
    const changing = [state.errors, state.reactions, state.systemState, Math.floor(knownAt / 1000)];
    const seen = [...changing, enabled, moment, volatile];
    const isEqual = seen.map((item, index) => item === this.#seen[index]);
    if (!isEqual.includes(false)) return;
    const isAtOnce = isEqual.slice(changing.length).includes(false);
    if (!isAtOnce && performance.now() - this.#shownAt < PAUSE_MS) return;
    this.#seen = seen;
    this.#shownAt = performance.now();
    this.#show({ ...view, compact: this.#isCompact });
  }

  #show(view) {
    const { state } = view;
    const others = otherReasons(state);
    renderOnce(this.reasons, JSON.stringify(others), () => (others.length ? [reasonTree(others)] : []));
    const { on, returned, silenced } = this.errors.show(view);
    const acting = this.reactions.show({ reactions: state.reactions, view });
    const wrong = on + others.length;
    const known = state.at !== null;
    setText(this.count, [counted(wrong, "wrong"), counted(acting, "acting")].filter(Boolean).join(", "));
    setAttribute(this.calm, "hidden", wrong > 0);
    const calm = returned + silenced ? "Nothing is wrong now" : "Nothing is wrong";
    setText(this.calm, known ? calm : "No data yet");
  }

  #fold(isCompact) {
    this.#isCompact = isCompact;
    this.errors.compact = isCompact;
  }

  #open() {
    this.#fold(false);
    this.heading.scrollIntoView({ block: "start" });
    this.heading.focus({ preventScroll: true });
  }
}

/** Reasons why the robot is in ERROR that are no errors which could be acknowledged. */
function otherReasons({ systemState, errors }) {
  const known = new Set(Object.values(errors).map(({ error }) => error));
  return (systemState?.reasons ?? []).filter(({ code }) => !known.has(code));
}

function counted(count, word) {
  return count ? `${count} ${word}` : "";
}

customElements.define("ph-why", Why);
