/** The one sentence that says how the robot is. */

import { taskWords } from "/web/js/task_words.js";
import { timeOfDay, wholeSeconds } from "/web/js/words.js";

/** The sentence at the top: `{level, word, text, more}`, most important reason first. */
export function stateSentence(state, contact) {
  const { systemState } = state;
  if (contact.level === "lost") {
    const since = state.at
      ? `values shown are from ${timeOfDay(state.at)}`
      : "nothing is known yet";
    return sentence("lost", `No contact for ${wholeSeconds(contact.silenceMs)}`, since);
  }
  if (systemState === null) return sentence("late", "Connecting", "waiting for the first values");
  const { state: word, reasons, errors, task_status } = systemState;
  const task = state.task ? taskWords(state.task) : TASKS[task_status];
  if (word !== "ERROR") return sentence(word.toLowerCase(), word, task);
  const [first = errors.join(", "), ...more] = reasons.map((reason) => reason.message);
  // Why it is paused is what the sentence begins with.
  const paused = state.task ? `, task ${state.task.id} is paused` : "";
  return sentence("error", "ERROR", first + paused, more);
}

function sentence(level, word, text, more = []) {
  return { level, word, text, more };
}

const TASKS = {
  NO_TASK: "no task",
  PAUSED_TASK: "the task is paused",
  RUNNING_TASK: "the task is running",
};
