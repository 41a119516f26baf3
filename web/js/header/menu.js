/** <ph-menu>: the what-if drawer, and a sheet with the scheme, the keys and the documents. */

import { el, icon } from "/web/js/base/dom.js";
import { setTheme, theme, THEMES } from "/web/js/base/theme.js";
import { KEYS, plainKeys, setPlainKeys } from "/web/js/header/keys.js";

class Menu extends HTMLElement {
  connectedCallback() {
    this.sheet = el(
      "div",
      { popover: "auto", class: "sheet", id: "menu", role: "dialog", "aria-label": "Menu" },
      this.#whatIf("menu-what-if"),
      el("h2", { id: "scheme-title" }, "Scheme"),
      schemeSwitch(),
      el("h2", { id: "keys-title" }, "Keys"),
      keyList(),
      keySwitch(),
      el("h2", {}, "Documents"),
      el("a", { class: "menu-link", href: "/docs" }, "API: requests and stream"),
    );
    const open = el("button", { type: "button", class: "open-menu", popovertarget: "menu", "aria-label": "Menu", title: "Menu" });
    open.append(icon("menu"));
    this.append(this.#whatIf("what-if"), open);
    // Not within the header, whose ground and text have the colours of the level.
    document.body.append(this.sheet);
    document.addEventListener("ph-keys", () => this.sheet.togglePopover());
  }

  #whatIf(name) {
    const button = el("button", { type: "button", class: name }, "What if …");
    button.addEventListener("click", () => {
      this.sheet.hidePopover();
      document.dispatchEvent(new CustomEvent("ph-what-if", { detail: {} }));
    });
    return button;
  }
}

function schemeSwitch() {
  const chosen = theme();
  const choices = THEMES.map((name) => {
    const input = el("input", { type: "radio", name: "scheme", value: name, checked: name === chosen });
    input.addEventListener("change", () => setTheme(name));
    return el("label", {}, input, el("span", {}, name[0].toUpperCase() + name.slice(1)));
  });
  return el("div", { class: "segments", role: "radiogroup", "aria-labelledby": "scheme-title" }, ...choices);
}

function keyList() {
  const rows = KEYS.flatMap(({ key, what }) => [el("dt", {}, el("kbd", {}, key)), el("dd", {}, what)]);
  return el("dl", { class: "keys", "aria-labelledby": "keys-title" }, ...rows);
}

function keySwitch() {
  const input = el("input", { type: "checkbox", role: "switch", checked: plainKeys() });
  input.addEventListener("change", () => setPlainKeys(input.checked));
  return el("label", { class: "switch" }, input, "Keys without a modifier");
}

customElements.define("ph-menu", Menu);
