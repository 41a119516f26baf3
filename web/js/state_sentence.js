/** The sentence that summarizes the state of the robot. */

import { currentTask } from "/web/js/store.js";
import { taskWords } from "/web/js/task_words.js";
import { timeOfDay, wholeSeconds } from "/web/js/words.js";

/** The sentence at the top: `{level, word, text, more}`, the most important reason first. */
export function stateSentence(state, contact) {
  const { systemState } = state;
  if (contact.level === "lost") {
    const since = state.at
      ? `values shown are from ${timeOfDay(state.at)}`
      : "no values received yet";
    return sentence("lost", `No contact for ${wholeSeconds(contact.silenceMs)}`, since);
  }
  if (systemState === null) return sentence("late", "Connecting", "waiting for the first values");
  const { state: word, reasons, errors, task_status } = systemState;
  const current = currentTask(state);
  const task = current ? taskWords(current) : TASKS[task_status];
  if (word !== "ERROR") return sentence(word.toLowerCase(), word, task);
  const [first = errors.join(", "), ...more] = reasons.map((reason) => reason.message);
  // The sentence starts with the reason for the pause.
  const paused = current ? `, task ${current.id} is paused` : "";
  return sentence("error", "ERROR", first + paused, more);
}

/** What was lost in a restart of the service; empty without one. */
export function restartWords({ restartedAt }) {
  if (restartedAt === null) return "";
  return `Service restarted at ${timeOfDay(restartedAt)}: earlier tasks and holds are gone.`;
}

function sentence(level, word, text, more = []) {
  return { level, word, text, more };
}

const TASKS = {
  NO_TASK: "no task",
  PAUSED_TASK: "the task is paused",
  RUNNING_TASK: "the task is running",
};
