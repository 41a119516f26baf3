/** <ph-part-device>: on which device a part is, how old its values are, what it does when cut off. */

import { heardLast, offlineWords } from "/web/js/base/device_words.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { label, timeAndDay, wholeSeconds } from "/web/js/base/words.js";

class PartDevice extends HTMLElement {
  connectedCallback() {
    if (this.old) return;
    this.old = el("p", { class: "note old" });
    this.where = el("p", { class: "facts" });
    this.append(this.old, this.where);
  }

  /** `device` is undefined for a part that is on no other computer. */
  show({ part, device, knownAt }) {
    setAttribute(this, "hidden", device === undefined);
    if (device === undefined) return;
    const heard = part.reachable === false ? heardLast(device) : null;
    setText(this.old, heard === null ? "" : oldWords(part, device, heard, knownAt));
    setText(this.where, `On device ${device.device}. ${offlineWords(device.offline, part.name)}`);
  }
}

function oldWords({ last_known: last }, { device }, heard, knownAt) {
  const when = `since ${timeAndDay(heard, knownAt)}, for ${wholeSeconds(Math.max(0, knownAt - heard))}`;
  const was = last ? ` It was ${label(last)} then.` : "";
  return `Device ${device} has not been heard ${when}.${was}`;
}

customElements.define("ph-part-device", PartDevice);
