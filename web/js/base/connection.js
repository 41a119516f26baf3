/** The stream: a WebSocket that reconnects by itself and tracks the age of its last frame. */

import { localNow } from "/web/js/base/clock.js";
import { parsePlain } from "/web/js/base/plain_json.js";
import { token } from "/web/js/base/token.js";

const LATE_MS = 1000;
const LOST_MS = 3000;
const SILENCE_MS = 5000;
const RETRY_MS = [500, 1000, 2000, 4000, 8000];
const UNAUTHORIZED = 4401;

/** Dispatches `frame` with the decoded frame as `detail`, and `unauthorized` if the token is
 * missing or wrong; then it does not reconnect by itself.
 *
 * `resume()` returns the query to continue with, or null for a fresh start.
 */
export class Connection extends EventTarget {
  #socket = null;
  #resume;
  #attempts = 0;
  #startedAt = 0;
  #lastFrameAt = null;
  #retryAt = null;
  #stopped = false;
  /** Frames that the service skipped for this page, since it was opened. */
  skipped = 0;

  constructor(resume) {
    super();
    this.#resume = resume;
    setInterval(() => this.#watch(), 250);
    const recheck = () => this.#recheck();
    document.addEventListener("visibilitychange", recheck);
    window.addEventListener("pageshow", recheck);
    // A tab that was frozen goes on with what is true now.
    document.addEventListener("resume", recheck);
    window.addEventListener("online", recheck);
  }

  /** Close the connection and reconnect at once. */
  tryNow() {
    this.#stopped = false;
    this.#retryAt = null;
    this.#startedAt = localNow();
    this.#drop();
    const query = this.#resume();
    const url = new URL("/ws", location.href);
    url.protocol = location.protocol === "https:" ? "wss:" : "ws:";
    if (query) url.search = new URLSearchParams(query);
    const socket = new WebSocket(url);
    this.#socket = socket;
    // A browser cannot set headers in the handshake.
    socket.onopen = () => {
      if (token() !== null) socket.send(JSON.stringify({ type: "auth", token: token() }));
    };
    socket.onmessage = ({ data }) => this.#take(parsePlain(data));
    socket.onclose = ({ code }) => {
      if (code === UNAUTHORIZED) this.#refused();
      else this.#closed();
    };
  }

  /** Close the connection until `tryNow` is called. */
  stop() {
    this.#stopped = true;
    this.#retryAt = null;
    this.#drop();
  }

  /** Note that a frame came another way, at a time in ms since 1970. */
  heardAt(at) {
    this.#lastFrameAt = at;
  }

  /** State of the connection: "connecting" (no frame yet), "live", "late" or "lost". */
  level() {
    if (this.#lastFrameAt === null) return this.#attempts < 2 ? "connecting" : "lost";
    const silence = this.silenceMs();
    if (silence > LOST_MS) return "lost";
    return silence > LATE_MS || this.#socket === null ? "late" : "live";
  }

  /** Time since the last frame, or since the page was opened. */
  silenceMs() {
    return localNow() - (this.#lastFrameAt ?? performance.timeOrigin);
  }

  /** Time until the next attempt; null while one is under way. */
  retryInMs() {
    return this.#retryAt === null ? null : Math.max(0, this.#retryAt - localNow());
  }

  #take(frame) {
    this.#lastFrameAt = localNow();
    this.#attempts = 0;
    this.skipped += frame.skipped ?? 0;
    this.dispatchEvent(new CustomEvent("frame", { detail: frame }));
  }

  #refused() {
    this.stop();
    this.dispatchEvent(new CustomEvent("unauthorized"));
  }

  #closed() {
    this.#socket = null;
    const wait = RETRY_MS[Math.min(this.#attempts, RETRY_MS.length - 1)];
    this.#attempts += 1;
    // Randomized, so that many pages do not reconnect to a restarted server at the same time.
    this.#retryAt = localNow() + wait * (0.8 + 0.4 * Math.random());
  }

  /** A dead peer never closes the socket: after a silence it is closed here, and reconnects. */
  #watch() {
    const quietSince = Math.max(this.#startedAt, this.#lastFrameAt ?? 0);
    if (this.#socket !== null && localNow() - quietSince > SILENCE_MS) {
      this.#drop();
      this.#closed();
    }
    if (this.#retryAt !== null && localNow() >= this.#retryAt) this.tryNow();
  }

  /** A page that was suspended does not wait for its timers. */
  #recheck() {
    if (this.#stopped) return;
    const quiet = this.#lastFrameAt !== null && this.silenceMs() > LOST_MS;
    if (!document.hidden && (quiet || this.#retryAt !== null)) this.tryNow();
  }

  #drop() {
    if (this.#socket === null) return;
    this.#socket.onopen = this.#socket.onmessage = this.#socket.onclose = null;
    this.#socket.close();
    this.#socket = null;
  }
}
