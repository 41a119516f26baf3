/** What an event follows from, on demand. */

import { request } from "/web/js/base/api.js";
import { el } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";
import { timeOfDay } from "/web/js/base/words.js";
import { whoIs } from "/web/js/timeline/commands.js";

const NAMED = 5;

/** A button that asks, and the line that has the answer. */
export function causesOf(event) {
  const line = el("p", { class: "event-causes", role: "status" });
  const button = el("button", { type: "button", "aria-expanded": "false" }, "because …");
  button.setAttribute("aria-label", `Why: ${event.words}`);
  button.addEventListener("click", async () => {
    if (line.textContent) {
      line.textContent = "";
      button.setAttribute("aria-expanded", "false");
      return;
    }
    await whileSending(button, async () => (line.textContent = await chainWords(event)));
    button.setAttribute("aria-expanded", "true");
  });
  return [button, line];
}

async function chainWords({ id }) {
  try {
    const { items } = await request("GET", `/events/${id}/causes`);
    return causeWords(items);
  } catch (error) {
    return `The cause cannot be shown: ${error.message}`;
  }
}

/** "because of gate is shut at 14:02:03, because of hold gate requested at 14:02:03 by anna". */
export function causeWords([, ...causes]) {
  if (causes.length === 0) return "The cause is no longer kept.";
  const said = causes.slice(0, NAMED).map(({ words, at, actor, cause }) => {
    const who = actor && cause === null ? ` by ${whoIs(actor)}` : "";
    return `because of ${words} at ${timeOfDay(at)}${who}`;
  });
  if (causes.length > NAMED) said.push(`and ${causes.length - NAMED} more before`);
  return said.join(", ");
}
