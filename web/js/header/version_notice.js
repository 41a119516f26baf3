/** <ph-version-notice>: asks to reload a page whose files are of another version than the service.
 *
 * It never reloads by itself: somebody may be about to press STOP.
 */

import { el } from "/web/js/base/dom.js";

class VersionNotice extends HTMLElement {
  connectedCallback() {
    this.setAttribute("role", "status");
  }

  /** Compare the version that the service tells with the one of this page. */
  compare(version) {
    const own = document.querySelector("meta[name=page-version]").content;
    this.hidden = version === own;
    if (this.hidden || this.hasChildNodes()) return;
    const reload = el("button", { type: "button", class: "small", onclick: () => location.reload() }, "Reload");
    this.append(el("p", { class: "grow" }, "This page is of another version than the service."), reload);
  }
}

customElements.define("ph-version-notice", VersionNotice);
