/** What is set about a signal, in words: pure functions. */

import { describe, valueText } from "/web/js/base/signal_catalog.js";
import { duration, modeName, timeAndDay } from "/web/js/base/words.js";

/** Return `[name, text]` of each fact, the most asked for first; `monitor` is of /monitors or null. */
export function factsOf(name, signal, monitor, now) {
  const { settings } = signal;
  const facts = [
    ["Name", name],
    ...boundsOf(settings).map(([prefix, error]) => [error, boundWords(name, signal, prefix)]),
    ["Holds", modeWords(settings.limits_because)],
    ["Computed", settings.of ? monitorWords(settings, monitor) : ""],
    ["Stale", settings.stale_after_s ? `after ${seconds(settings.stale_after_s)}` : "never"],
    ["Takes", rangeWords(name, signal)],
    ["Source", sourceWords(signal, now)],
  ];
  return facts.filter(([, text]) => text);
}

/** What an operator should know about the signal now; empty if there is nothing. */
export function noteOf({ source_fault, needs_acknowledgement, skewed, error }) {
  const notes = [
    source_fault ? `No reading: ${source_fault}.` : "",
    needs_acknowledgement ? `${error} goes on until somebody acknowledges it.` : "",
    skewed ? "The clock of its sender differs from the robot's by more than 1 s." : "",
  ];
  return notes.filter(Boolean).join(" ");
}

/** Threshold, where it clears, and which side is bad; null for a signal without a threshold. */
export function limitOf({ threshold, clear_threshold, bad_side }) {
  return typeof threshold === "number" ? { threshold, clear: clear_threshold, side: bad_side } : null;
}

function boundsOf(settings) {
  return Object.entries(settings)
    .filter(([key]) => key === "error" || key.endsWith("_error"))
    .map(([key, error]) => [key.slice(0, -"error".length), error]);
}

function boundWords(name, signal, prefix) {
  const of = (key) => signal.settings[prefix + key];
  const value = (shown) => valueText(name, signal, shown);
  const [threshold, clear, for_s] = [of("threshold"), of("clear_threshold"), of("for_s")];
  const bad = threshold === undefined ? value(of("bad_value")) : `${of("bad_side")} ${value(threshold)}`;
  const lasting = for_s ? ` for ${seconds(for_s)}` : "";
  const ends = threshold !== undefined && clear !== threshold ? `, ends at ${value(clear)}` : "";
  const seen = signal.settings.recovery === "acknowledge" ? ", acknowledged" : "";
  return `when ${bad}${lasting}${ends}${seen}`;
}

function modeWords(because) {
  if (!because) return "";
  if (because === "default") return "in all other modes";
  const dot = because.lastIndexOf(".");
  return `while ${because.slice(0, dot)} is in ${modeName(because.slice(dot + 1))}`;
}

function monitorWords({ of, statistic, window_s, window_n }, monitor) {
  const source = describe(of, {}).label;
  const window = window_s ? `over ${seconds(window_s)}` : `over ${window_n} readings`;
  const filled = monitor && monitor.filled < 1 ? `, ${Math.floor(monitor.filled * 100)} % of it so far` : "";
  return `${statistic.replaceAll("_", " ")} of ${source}, ${window}${filled}`;
}

function rangeWords(name, signal) {
  const { minimum, maximum, members } = signal.settings;
  const value = (shown) => valueText(name, signal, shown);
  if (members) return members.split(", ").map(value).join(", ");
  if (typeof minimum === "number" && typeof maximum === "number")
    return `${value(minimum)} to ${value(maximum)}`;
  if (typeof minimum === "number") return `${value(minimum)} and more`;
  return typeof maximum === "number" ? `up to ${value(maximum)}` : "";
}

function sourceWords({ source, received_at }, now) {
  if (!received_at) return "no reading yet";
  return `${source}, last reading at ${timeAndDay(received_at, now)}`;
}

function seconds(value_s) {
  return duration(value_s * 1000).replace(".0 s", " s");
}
