/** The title of the page: it is also seen while the page is hidden. */

import { attention } from "/web/js/base/attention.js";
import { robotSentence } from "/web/js/base/state_sentence.js";

/** Show in the title what the robot does, or what keeps that from being known. */
export function showTitle(state, { level }, isLocked) {
  const known = `${attention(state.errors)}${wordOf(state, level)}`;
  const text = `${isLocked ? "Token needed" : known} · Pilothouse`;
  if (document.title !== text) document.title = text;
}

function wordOf(state, level) {
  if (state.replay) return "REPLAY";
  return level === "lost" ? "No contact" : (robotSentence(state)?.word ?? "Connecting");
}
