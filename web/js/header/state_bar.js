/** <ph-state-bar>: the state of the robot in one line, coloured by its level, and chips below it. */

import { el, icon, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { rememberedWords } from "/web/js/base/restart_words.js";
import { stateSentence, storageSentence } from "/web/js/base/state_sentence.js";
import { currentTask } from "/web/js/base/store.js";
import "/web/js/header/chips.js";

class StateBar extends HTMLElement {
  connectedCallback() {
    this.symbol = el("span", { class: "symbol" });
    this.word = el("strong");
    this.text = el("span");
    this.sentence = el("h1", { class: "sentence" }, this.word, this.text);
    this.count = el("span");
    this.more = el("button", { type: "button", class: "more", hidden: true });
    this.more.append(this.count, el("span", { class: "more-word" }, " more"));
    this.more.addEventListener("click", () => {
      this.dispatchEvent(new CustomEvent("ph-why", { bubbles: true }));
    });
    this.chips = el("ph-chips");
    this.spoken = el("p", { class: "visually-hidden", role: "status", "aria-live": "polite" });
    const line = el("div", { class: "sentence-line" }, this.sentence, this.more);
    this.append(this.symbol, el("div", { class: "said" }, line, this.chips), this.spoken);
  }

  update(view) {
    const { live, contact } = view;
    const said = stateSentence(live, contact);
    setAttribute(this, "data-level", said.level);
    setAttribute(this.parentElement, "data-level", said.level);
    renderOnce(this.symbol, said.sign, () => [icon(said.sign)]);
    setText(this.word, `${said.word}: `);
    setText(this.text, said.text);
    setAttribute(this.sentence, "title", [`${said.word}: ${said.text}`, ...said.more].join("\n"));
    setAttribute(this.more, "hidden", said.more.length === 0);
    setText(this.count, `+${said.more.length}`);
    setAttribute(this.more, "aria-label", `+${said.more.length} more: why`);
    setAttribute(this.more, "title", said.more.join("\n"));
    this.chips.show(view);
    this.#speak(live, said, storageSentence(live, contact));
  }

  /** Screen readers announce changes of the state, and not each figure that changes in it. */
  #speak(state, said, storage) {
    const errors = state.systemState?.errors ?? [];
    const { id, status, reason } = currentTask(state) ?? {};
    const begun = [id, status, reason, state.restartedAt, storage?.word];
    const key = [said.level, said.sign, errors, ...begun].join();
    if (this.spokenKey === key) return;
    this.spokenKey = key;
    const word = said.level === "lost" ? "No contact" : said.word;
    const fails = storage ? `${storage.word}: ${storage.text}` : "";
    const words = [`${word}: ${said.text}`, ...said.more, fails, rememberedWords(state)];
    setText(this.spoken, words.filter(Boolean).join("; "));
  }
}

customElements.define("ph-state-bar", StateBar);
