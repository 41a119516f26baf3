/** <ph-token-form>: asks for the token of the service; dispatches `ph-token` once it is correct.
 *
 * While it is open, nothing else of the page is shown.
 */

import { request } from "/web/js/base/api.js";
import { el, setText } from "/web/js/base/dom.js";
import { setToken } from "/web/js/base/token.js";

const WRONG = "Wrong token.";

class TokenForm extends HTMLElement {
  connectedCallback() {
    this.input = el("input", {
      type: "password",
      id: "token",
      name: "token",
      autocomplete: "current-password",
      required: true,
      "aria-describedby": "token-note token-error",
    });
    this.button = el("button", { type: "submit" }, "Use this token");
    this.error = el("p", { id: "token-error", class: "error", role: "alert" });
    // Password managers need a user name.
    const name = { type: "text", autocomplete: "username", value: "pilothouse", hidden: true };
    const form = el(
      "form",
      {},
      el("h2", {}, "This robot requires a token"),
      el(
        "p",
        { id: "token-note" },
        "Without it this page can neither show the robot nor stop it: use the hardware stop.",
      ),
      el("label", { for: "token" }, "Token"),
      el("input", name),
      this.input,
      this.error,
      this.button,
      el("p", { class: "quiet" }, "It is kept until this tab is closed."),
    );
    form.addEventListener("submit", (event) => {
      event.preventDefault();
      this.#try(this.input.value.trim());
    });
    this.append(form);
  }

  get isOpen() {
    return !this.hidden;
  }

  /** Ask, unless it is asked already. */
  ask() {
    if (this.isOpen) return;
    this.hidden = false;
    document.body.toggleAttribute("data-locked", true);
    this.input.focus();
  }

  async #try(value) {
    this.button.disabled = true;
    setText(this.error, "");
    const refusal = await check(value);
    this.button.disabled = false;
    if (refusal !== null) {
      setText(this.error, refusal);
      this.input.select();
      return;
    }
    this.input.value = "";
    this.hidden = true;
    document.body.toggleAttribute("data-locked", false);
    this.dispatchEvent(new CustomEvent("ph-token", { bubbles: true }));
  }
}

/** Return what is wrong with a token, or null; a right one is in use from then on. */
async function check(value) {
  // A token must be valid in a header.
  if (!/^[!-~]+$/.test(value)) return WRONG;
  setToken(value);
  try {
    await request("GET", "/system_state");
    return null;
  } catch (error) {
    setToken(null);
    return error.status === 401 ? WRONG : error.message;
  }
}

customElements.define("ph-token-form", TokenForm);
