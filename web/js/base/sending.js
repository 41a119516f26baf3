/** Shows at once that a press was taken, however long the answer takes. */

import { el, setAttribute } from "/web/js/base/dom.js";

/** Run `act` with a mark on the button until it has ended; meanwhile further presses do nothing. */
export async function whileSending(button, act) {
  if (button.hasAttribute("data-sending")) return;
  const mark = el("span", { class: "sent", role: "status" }, "sent …");
  setAttribute(button, "data-sending", true);
  button.append(mark);
  try {
    await act();
  } finally {
    mark.remove();
    setAttribute(button, "data-sending", false);
  }
}
