/** Requests to the server; whatever goes wrong becomes a ProblemError with words to show. */

/** A refusal or failure as RFC 9457 describes it. */
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
  detail: "The server did not answer. Whether it was done is not known.",
};

/** Send a request and return the JSON of the answer.
 *
 * @throws {ProblemError} On any status from 400, and where no answer comes within `timeoutMs`.
 */
export async function request(method, path, body, { keepalive = false, timeoutMs = 8000 } = {}) {
  const options = { method, keepalive, cache: "no-store", headers: { Accept: "application/json" } };
  options.signal = AbortSignal.timeout(timeoutMs);
  if (body !== undefined) {
    options.headers["Content-Type"] = "application/json";
    options.body = JSON.stringify(body);
  }
  let response, text;
  try {
    response = await fetch(path, options);
    text = await response.text();
  } catch {
    throw new ProblemError(NO_ANSWER);
  }
  const answer = parse(text);
  if (response.ok) return answer;
  const unnamed = { title: `HTTP ${response.status}`, detail: response.statusText };
  throw new ProblemError({ ...unnamed, ...answer, status: response.status });
}

/** Path of a part; its name may hold slashes, which stay. */
export function partPath(part) {
  return `/${part.kind}s/${part.name.split("/").map(encodeURIComponent).join("/")}`;
}

function parse(text) {
  try {
    return JSON.parse(text);
  } catch {
    return null;
  }
}
