/** Requests to the server; every failure becomes a ProblemError with a text to show. */

import { parsePlain } from "/web/js/base/plain_json.js";
import { token } from "/web/js/base/token.js";

/** A rejected or failed request, as a problem document of RFC 9457. */
export class ProblemError extends Error {
  constructor(problem) {
    super(problem.detail || problem.title);
    this.problem = problem;
  }

  get status() {
    return this.problem.status;
  }
}

const NO_ANSWER = {
  title: "No answer",
  status: 0,
  code: "NO_CONTACT",
  detail: "The server did not answer. It is not known whether the request was carried out.",
};

/** Send a request and return the JSON of the answer.
 *
 * A body is sent as JSON, or as plain text if its media `type` is given.
 *
 * If the token is missing or wrong, `ph-unauthorized` is dispatched on the document as well. So is
 * `ph-unstored` if what was asked for is done and not on disk yet, and `ph-storage-refused` if it is
 * not done because it cannot be stored.
 *
 * @throws {ProblemError} On any status from 400, and if there is no answer within `timeoutMs`.
 */
export async function request(method, path, body, options = {}) {
  return parse(await exchange(method, path, body, options));
}

/** Return the text of a file, with errors as those of `request`. */
export function requestText(path) {
  return exchange("GET", path, undefined, { accept: "*/*" });
}

async function exchange(
  method,
  path,
  body,
  { keepalive = false, timeoutMs = 8000, type, accept = "application/json" },
) {
  const options = { method, keepalive, cache: "no-store", headers: { Accept: accept } };
  options.signal = AbortSignal.timeout(timeoutMs);
  const sent = token();
  if (sent !== null) options.headers.Authorization = `Bearer ${sent}`;
  if (body !== undefined) {
    options.headers["Content-Type"] = type ?? "application/json";
    options.body = type ? body : JSON.stringify(body);
  }
  let response, text;
  try {
    response = await fetch(path, options);
    text = await response.text();
  } catch {
    throw new ProblemError(NO_ANSWER);
  }
  if (response.headers.get("Pilothouse-Durable") === "false") tell("ph-unstored");
  if (response.ok) return text;
  // An answer to a request with an earlier token is no evidence about the current one.
  if (response.status === 401 && sent === token()) tell("ph-unauthorized");
  const unnamed = { title: `HTTP ${response.status}`, detail: response.statusText };
  const problem = { ...unnamed, ...parse(text), status: response.status };
  if (problem.code === "STORAGE_DEGRADED" && method !== "GET") tell("ph-storage-refused");
  throw new ProblemError(problem);
}

function tell(name) {
  document.dispatchEvent(new CustomEvent(name));
}

/** Path of a part; slashes in its name are kept. */
export function partPath(part) {
  return `/${part.kind}s/${part.name.split("/").map(encodeURIComponent).join("/")}`;
}

function parse(text) {
  try {
    return parsePlain(text);
  } catch {
    return null;
  }
}
