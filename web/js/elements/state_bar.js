/** <ph-state-bar>: the state of the robot in one sentence, its reasons, and the connection. */

import { el, icon, renderOnce, setAttribute, setText } from "/web/js/dom.js";
import { restartWords, stateSentence } from "/web/js/state_sentence.js";
import { currentTask } from "/web/js/store.js";
import { wholeSeconds } from "/web/js/words.js";

class StateBar extends HTMLElement {
  connectedCallback() {
    this.word = el("strong");
    this.text = el("span");
    this.symbol = el("span", { class: "symbol" });
    this.more = el("ul", { class: "reasons" });
    this.acknowledge = el("ph-acknowledge");
    this.simulated = el("span", { class: "badge", hidden: true });
    this.contact = el("span", { class: "contact" });
    this.tryNow = el("button", { type: "button", class: "small", hidden: true }, "Try now");
    this.tryNow.addEventListener("click", () => this.emit("ph-try-now"));
    this.restart = el("span");
    const read = el("button", { type: "button", class: "small" }, "Dismiss");
    read.addEventListener("click", () => this.emit("ph-restart-read"));
    this.notice = el("p", { class: "notice", hidden: true }, this.restart, read);
    this.spoken = el("p", { class: "visually-hidden", role: "status", "aria-live": "polite" });
    this.append(
      this.symbol,
      el(
        "div",
        { class: "said" },
        el("h1", { class: "sentence" }, this.word, this.text),
        this.more,
        this.acknowledge,
        this.notice,
        el("p", { class: "facts" }, this.contact, this.tryNow, this.simulated),
      ),
      this.spoken,
    );
  }

  emit(name) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true }));
  }

  update({ state, contact }) {
    const said = stateSentence(state, contact);
    setAttribute(this, "data-level", said.level);
    renderOnce(this.symbol, said.sign, () => [icon(said.sign)]);
    setText(this.word, `${said.word}: `);
    setText(this.text, said.text);
    renderOnce(this.more, said.more.join("\n"), () => said.more.map((text) => el("li", {}, text)));
    this.acknowledge.show(state.signals, contact.level !== "lost");
    const restart = restartWords(state);
    setAttribute(this.notice, "hidden", restart === "");
    setText(this.restart, restart);
    this.#updateFacts(state, contact);
    this.#speak(state, said);
  }

  #updateFacts(state, contact) {
    const simulated = state.systemState?.simulated ?? [];
    setAttribute(this.simulated, "hidden", simulated.length === 0);
    setText(this.simulated, `simulated: ${simulated.join(", ")}`);
    setText(this.contact, contactWords(contact));
    setAttribute(this.tryNow, "hidden", contact.retryInMs === null || contact.level === "live");
  }

  /** Screen readers announce changes of the state, and not each figure that changes in it. */
  #speak(state, said) {
    const errors = state.systemState?.errors ?? [];
    const { id, status, reason } = currentTask(state) ?? {};
    const key = [said.level, said.sign, errors, id, status, reason, state.restartedAt].join();
    if (this.spokenKey === key) return;
    this.spokenKey = key;
    const word = said.level === "lost" ? "No contact" : said.word;
    setText(this.spoken, [`${word}: ${said.text}`, ...said.more, restartWords(state)].filter(Boolean).join("; "));
  }
}

function contactWords({ level, silenceMs, retryInMs }) {
  if (level === "live") return "Connected";
  const late = level === "late" ? `Late: last values ${wholeSeconds(silenceMs)} ago. ` : "";
  if (retryInMs === null) return `${late}Connecting …`;
  return `${late}Next attempt in ${Math.ceil(retryInMs / 1000)} s`;
}

customElements.define("ph-state-bar", StateBar);
