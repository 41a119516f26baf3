/** Texts on errors: pure functions. */

import { isOn } from "/web/js/base/error_groups.js";
import { valueText } from "/web/js/base/signal_catalog.js";
import { duration, timeAndDay, wholeSeconds } from "/web/js/base/words.js";

/** Name of the signal that an error is of; undefined: of none. */
export function signalOf({ error, part, message }, signals) {
  const isOf = ({ settings }) =>
    (settings.part ?? null) === part &&
    Object.entries(settings).some(([name, value]) => value === error && /(^|_)error$/.test(name));
  const found = Object.values(signals).find(isOf)?.signal;
  return found ?? message.split(/[\s,:;]+/).find((word) => Object.hasOwn(signals, word));
}

/** "2.5, limit 1": what was measured, if the message does not tell it; empty without both. */
export function measured({ value, threshold, message }, signal) {
  if (typeof value !== "number" || typeof threshold !== "number") return "";
  if (signal && message.includes(" is ")) return "";
  // The error of a part may have numbers, and no signal that says in which unit.
  const { signal: name, ...facts } = signal ?? { signal: "", unit: "" };
  const [said, limit] = [value, threshold].map((number) => valueText(name, facts, number));
  return `${said}, limit ${limit}`;
}

/** "12 s" for one that is on, when another one ended; empty: not known. */
export function ageWords(error, knownAt) {
  const { state, since_at: since, ended_at: ended } = error;
  if (isOn(error)) return since ? wholeSeconds(knownAt - Date.parse(since)) : "";
  return state === "returned" && ended ? timeAndDay(ended) : "";
}

/** What is special about an error, each in a word or two. */
export function tagsOf({ state, first_out, chattering, suppressed, shelved_until_at }) {
  return [
    STATES[state] ?? "",
    chattering ? "chattering" : "",
    shelved_until_at ? "shelved" : "",
    suppressed ? "suppressed" : "",
    first_out ? "first" : "",
  ].filter(Boolean);
}

/** What returned is under a heading that says so. */
const STATES = { latched: "latched", acknowledged: "acknowledged" };

/** What the tags mean for whoever reads them, and how often it happened. */
export function factsOf(error) {
  const { state, since_at: since, ended_at: ended, count, first_out } = error;
  const facts = [MEANINGS[state] ?? ""];
  if (state === "returned" && since) {
    const lasted = ended ? `, for ${duration(Date.parse(ended) - Date.parse(since))}` : "";
    facts.push(`from ${timeAndDay(since)}${lasted}`);
  }
  if (first_out) facts.push("it came before the others");
  if (count > 1) facts.push(`${count} times`);
  if (error.shelved_until_at !== null)
    facts.push(`shelved until ${timeAndDay(error.shelved_until_at)}: ${error.shelved_because}`);
  if (error.suppressed) facts.push("suppressed by the model");
  return facts.filter(Boolean).join(" · ");
}

const MEANINGS = {
  latched: "its cause is gone; it waits for you",
  acknowledged: "acknowledged",
  returned: "it is over; nobody has acknowledged it",
};

/** What would help; a setting is told by what it does. */
export function hintOf({ hint }) {
  return (hint ?? "").replace(/\bclear_for_s: (\S+) would calm it/, "it would be calm if it ended only after $1 s");
}
