/** <ph-why>: what is wrong with the robot, why, and what it does about it by itself.
 *
 * Errors and further reasons are one list, the worst first. Once somebody selected a part they are
 * closed, so that the part below is in sight; the event `ph-why` opens the first again.
 */

import { el, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { errorName, isOn } from "/web/js/base/error_groups.js";
import { errorWords, stateSentence } from "/web/js/base/state_sentence.js";
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
    this.others = el("ul", { class: "others", "aria-label": "Further reasons" });
    this.errors = el("ph-alarm-list");
    this.reactions = el("ph-reaction-list");
    const head = el("div", { class: "why-head" }, this.heading, this.calm);
    this.append(head, this.others, this.errors, this.reactions);
    document.addEventListener("ph-select", () => this.#fold(true));
    document.addEventListener("ph-why", () => this.#fold(false));
  }

  update(view) {
    const { state, enabled, moment, knownAt, volatile, contact } = view;
    const changing = [state.errors, state.reactions, state.systemState, Math.floor(knownAt / 1000)];
    const seen = [...changing, enabled, moment, volatile, contact.level];
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
    const others = otherReasons(view);
    renderOnce(this.others, others.join("\n"), () => others.map((text) => el("li", {}, text)));
    const { on, returned, silenced } = this.errors.show(view);
    const acting = this.reactions.show({ reactions: state.reactions, view });
    const counts = [counted(on, "wrong"), counted(acting, "acting")].filter(Boolean);
    setText(this.count, counts.join(", "));
    setAttribute(this.calm, "hidden", on > 0 || others.length > 0);
    const calm = returned + silenced ? "Nothing is wrong now" : "Nothing is wrong";
    setText(this.calm, state.at === null ? "No data yet" : calm);
  }

  #fold(isCompact) {
    this.#isCompact = isCompact;
    this.errors.compact = isCompact;
  }
}

/** What the sentence of the header tells beside errors: holds, a vehicle that moves, contact. */
function otherReasons({ live, state, contact }) {
  const said = stateSentence(state, state === live ? contact : { level: "live" });
  if (said.level === "calm") return [];
  const told = Object.values(state.errors).filter(isOn).flatMap((error) => [toldBy(error), errorWords(error)]);
  const isTold = (line) => told.some((words) => line.startsWith(words)) || (told.length > 0 && isRest(line));
  return [said.text, ...said.more].filter((line) => !isTold(line));
}

/** Whether a line counts what stands beside that which the header names; the errors name all. */
function isRest(line) {
  return /^\d+ more such (parts?|devices|errors?)$/.test(line);
}

/** How the line begins that an error makes superfluous. */
function toldBy(error) {
  if (error.error === "UNREACHABLE") return `${error.part} is unreachable`;
  if (error.error === "LOST") return `device ${error.part} is lost`;
  return error.message || errorName(error);
}

function counted(count, word) {
  return count ? `${count} ${word}` : "";
}

customElements.define("ph-why", Why);
