/** <ph-notices>: bands for what asks for a person: an acknowledgement, storage, a restart. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { rememberedWords, waitingWords } from "/web/js/base/restart_words.js";
import { storageSentence } from "/web/js/base/state_sentence.js";
import "/web/js/header/acknowledge.js";

class Notices extends HTMLElement {
  #restart = { at: null, words: null };

  connectedCallback() {
    this.acknowledge = el("ph-acknowledge", { class: "band", hidden: true });
    this.storageWord = el("strong");
    this.storageText = el("span");
    this.storage = el("p", { class: "band storage", hidden: true }, el("span", { class: "grow" }, this.storageWord, this.storageText));
    this.restart = el("span", { class: "grow" });
    const read = el("button", { type: "button", class: "small" }, "Dismiss");
    read.addEventListener("click", () => {
      this.dispatchEvent(new CustomEvent("ph-restart-read", { bubbles: true }));
    });
    this.notice = el("p", { class: "band notice", hidden: true }, this.restart, read);
    this.append(this.acknowledge, this.storage, this.notice);
  }

  update({ live, contact, volatile }) {
    const enabled = contact.level !== "lost" && !live.replay;
    this.acknowledge.show({ signals: live.signals, enabled, volatile });
    const storage = storageSentence(live, contact);
    setAttribute(this.storage, "hidden", storage === null);
    setText(this.storageWord, storage ? `${storage.word}: ` : "");
    setText(this.storageText, storage?.text ?? "");
    this.#showRestart(live);
  }

  /** What it remembers is told as it was found after the restart: later things are no memories. */
  #showRestart(state) {
    if (this.#restart.at !== state.restartedAt) this.#restart = { at: state.restartedAt, words: null };
    this.#restart.words ??= rememberedWords(state);
    const { words } = this.#restart;
    setAttribute(this.notice, "hidden", words === null);
    if (words === null) return;
    const waiting = waitingWords(state);
    setText(this.restart, waiting ? `${words}; ${waiting}.` : `${words}.`);
  }
}

customElements.define("ph-notices", Notices);
