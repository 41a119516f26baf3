/** What somebody asked for, in words: pure functions. */

/** What a rejected request was about, by the path that it went to. */
const SUBJECTS = [
  [/^\/emergency_stop/, () => "emergency stop"],
  [/^\/holds\/(.+)/, (owner) => `hold ${owner}`],
  [/^\/tasks/, () => "task"],
  [/^\/mock\/(.+)/, (signal) => `simulated ${signal}`],
  [/^\/signals\/(.+)/, (signal) => `value of ${signal}`],
  [/^\/(?:systems|nodes)\/(.+)\/errors\/([^/]+)/, (part, error) => `${error} of ${part}`],
  [/^\/(?:systems|nodes)\/(.+)\/(mode|state|parameters)$/, (part, what) => `${what} of ${part}`],
  [/^\/errors\/([^/]+)/, (error) => error],
];
const NO_COMMANDS = ["signal.read", "error.reported", "task.served"];

/** A command as `{text, tone, who}`; null: the event is none. */
export function commandOf({ kind, cause, actor, data, words }) {
  if (kind === "audit.write") return auditOf(data, actor);
  if (cause !== null || !actor || NO_COMMANDS.includes(kind)) return null;
  return { text: words, who: whoIs(actor), tone: "command" };
}

/** What was accepted has an event of its own, but for what only the mock takes. */
function auditOf({ method, path, status }, actor) {
  const isRejected = status >= 400;
  if (!isRejected && !path.startsWith("/mock/")) return null;
  const subject = subjectOf(path);
  const text = isRejected ? `rejected: ${subject}` : `${subject} set`;
  const isEnd = method === "DELETE" && isRejected;
  const said = isEnd ? `rejected: end of ${subject}` : text;
  return { text: said, who: whoIs(actor), tone: isRejected ? "rejected" : "command" };
}

function subjectOf(path) {
  for (const [pattern, words] of SUBJECTS) {
    const found = pattern.exec(path);
    if (found) return words(...found.slice(1).map(decode));
  }
  return "request";
}

function decode(text) {
  try {
    return decodeURIComponent(text);
  } catch {
    return text;
  }
}

/** Who asked, without the way the request came: "http:anna" is "anna". */
export function whoIs(actor) {
  return (actor ?? "").replace(/^[a-z]+:/, "");
}
