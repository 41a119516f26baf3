/** <ph-state-bar>: the state of the robot in one sentence, its reasons, and the connection. */

import { el, icon, renderOnce, setAttribute, setText } from "/web/js/base/dom.js";
import { restartWords, stateSentence, storageSentence } from "/web/js/base/state_sentence.js";
import { currentTask } from "/web/js/base/store.js";
import { wholeSeconds } from "/web/js/base/words.js";

const UNSTORED_MS = 5000;

class StateBar extends HTMLElement {
  #unstoredAt = -Infinity;

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
    this.storageWord = el("strong");
    this.storageText = el("span");
    const storageSaid = el("span", {}, this.storageWord, this.storageText);
    this.storage = el("p", { class: "storage", hidden: true }, storageSaid);
    this.unstored = el("span", { role: "status" });
    document.addEventListener("ph-unstored", () => (this.#unstoredAt = performance.now()));
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
        this.storage,
        this.notice,
        el("p", { class: "facts" }, this.contact, this.tryNow, this.unstored, this.simulated),
      ),
      this.spoken,
    );
  }

  emit(name) {
    this.dispatchEvent(new CustomEvent(name, { bubbles: true }));
  }

  update({ state, contact, volatile }) {
    const said = stateSentence(state, contact);
    setAttribute(this, "data-level", said.level);
    renderOnce(this.symbol, said.sign, () => [icon(said.sign)]);
    setText(this.word, `${said.word}: `);
    setText(this.text, said.text);
    renderOnce(this.more, said.more.join("\n"), () => said.more.map((text) => el("li", {}, text)));
    const enabled = contact.level !== "lost";
    this.acknowledge.show({ signals: state.signals, enabled, volatile });
    const storage = storageSentence(state, contact);
    setAttribute(this.storage, "hidden", storage === null);
    setText(this.storageWord, storage ? `${storage.word}: ` : "");
    setText(this.storageText, storage?.text ?? "");
    const restart = restartWords(state);
    setAttribute(this.notice, "hidden", restart === "");
    setText(this.restart, restart);
    this.#updateFacts(state, contact);
    this.#speak(state, said, storage);
  }

  #updateFacts(state, contact) {
    const simulated = state.systemState?.simulated ?? [];
    setAttribute(this.simulated, "hidden", simulated.length === 0);
    setText(this.simulated, `simulated: ${simulated.join(", ")}`);
    setText(this.contact, contactWords(contact));
    const isUnstored = performance.now() - this.#unstoredAt < UNSTORED_MS;
    setText(this.unstored, isUnstored ? "Done; not on disk yet" : "");
    setAttribute(this.tryNow, "hidden", contact.retryInMs === null || contact.level === "live");
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
    const words = [`${word}: ${said.text}`, ...said.more, fails, restartWords(state)];
    setText(this.spoken, words.filter(Boolean).join("; "));
  }
}

function contactWords({ level, silenceMs, retryInMs }) {
  if (level === "live") return "Connected";
  const late = level === "late" ? `Late: last values ${wholeSeconds(silenceMs)} ago. ` : "";
  if (retryInMs === null) return `${late}Connecting …`;
  return `${late}Next attempt in ${Math.ceil(retryInMs / 1000)} s`;
}

customElements.define("ph-state-bar", StateBar);
