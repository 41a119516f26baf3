/** On a narrow screen a part opens in place of the list, and going back in the history closes it. */

const NARROW = "(max-width: 1023px)";

export class PartScreen {
  #from = "parts";
  #closed;

  /** `closed()` is called when the list is in sight again. */
  constructor(closed) {
    this.#closed = closed;
    addEventListener("popstate", () => this.#close());
  }

  get #isOpen() {
    return document.body.hasAttribute("data-part-open");
  }

  /** Open the part; return whether that is how this screen shows it. */
  open() {
    if (!matchMedia(NARROW).matches) return false;
    if (!this.#isOpen) {
      this.#from = document.body.dataset.tab;
      history.pushState({ part: true }, "");
      document.body.toggleAttribute("data-part-open", true);
    }
    tab("parts");
    document.querySelector("main").scrollTop = 0;
    return true;
  }

  /** Go back as the gesture of a phone does. */
  back() {
    if (history.state?.part) history.back();
    else this.#close();
  }

  #close() {
    if (!this.#isOpen) return;
    document.body.toggleAttribute("data-part-open", false);
    tab(this.#from);
    if (this.#from === "parts") this.#closed();
  }
}

function tab(name) {
  if (document.body.dataset.tab === name) return;
  document.dispatchEvent(new CustomEvent("ph-tab", { detail: name }));
}
