/** Loads what the stream does not carry of the selected part.
 *
 * That is the available transitions and modes, what blocks them, the parameters of a node, and the
 * progress of its last change; while someone looks at them, also why the part is not where it should
 * be, and the plan of a request.
 */

import { partPath, request } from "/web/js/base/api.js";
import { isOpen } from "/web/js/base/words.js";

// One load is up to six requests, so a burst of events must not cause a burst of loads.
const PAUSE_MS = 500;

/** Ask for the plan of a request; it has the `path` and `body` of that besides.
 *
 * @throws {ProblemError} The request would be rejected.
 */
export async function requestPlan({ path, body }) {
  return { ...(await request("POST", `${path}?dry_run=true`, body)), path, body };
}

/** Calls `changed` after each load; the fields below are the newest answers. */
export class PartWatch {
  part = null;
  transitions = [];
  modes = [];
  change = null;
  /** Of a node; null: it is a system, or they are not known yet. */
  parameters = null;
  /** Whether there was an answer about the part. */
  isLoaded = false;
  /** Null unless `explain` asked for it. */
  why = null;
  /** What `requestPlan` returned, and null once it is to be forgotten. */
  plan = null;
  #changed;
  #isExplained = false;
  #changeId = null;
  #epoch = null;
  #busy = false;
  #again = false;

  constructor(changed) {
    this.#changed = changed;
  }

  /** Follow another part. */
  async select(part) {
    this.part = part;
    this.transitions = this.modes = [];
    this.change = this.why = this.plan = this.parameters = null;
    this.isLoaded = false;
    this.#changeId = part.change;
    this.#changed();
    this.refresh();
    const [{ items }] = await this.#answers(["/changes"]);
    const last = items?.find((change) => change.part === part.name);
    if (this.part === part && last && this.#changeId === null) this.follow(last);
  }

  /** Take from a frame the running change of the part, or the one that has just ended.
   *
   * A quick change can start and end between two frames: then only its events name it.
   */
  hear(frame) {
    if (frame.type === "hello") this.#begin(frame.epoch);
    if (this.part === null) return;
    if (frame.type === "state") this.#name(frame.parts?.[this.part.name]?.change);
    if (frame.type !== "event") return;
    const { part, change } = frame.data;
    // The change that supersedes another one is newer, and known from its own frames.
    if (part === this.part.name && frame.kind !== "change.superseded") this.#name(change);
    this.refresh();
  }

  /** Load now, or once more after the running load, so that a burst causes two loads only. */
  async refresh() {
    if (this.part === null) return;
    if (this.#busy) {
      this.#again = true;
      return;
    }
    this.#busy = true;
    this.#again = false;
    await this.#load(this.part);
    setTimeout(() => {
      this.#busy = false;
      if (this.#again || this.change?.status === "running") this.refresh();
    }, PAUSE_MS);
  }

  /** Follow a change that was just requested, or that was the last. */
  follow(change) {
    this.change = change;
    this.#changeId = change.id;
    this.#changed();
    this.refresh();
  }

  /** Say whether the reasons why the part is not where it should be are looked at. */
  explain(isLookedAt) {
    if (isLookedAt === this.#isExplained) return;
    this.#isExplained = isLookedAt;
    this.why = null;
    if (isLookedAt) this.refresh();
  }

  /** Ids of changes start again after a restart: an old id would name another change. */
  #begin(epoch) {
    if (epoch !== this.#epoch) this.change = this.#changeId = null;
    this.#epoch = epoch;
  }

  #name(change) {
    if (!change || change === this.#changeId) return;
    this.#changeId = change;
    this.refresh();
  }

  async #load(part) {
    const path = partPath(part);
    const paths = [`${path}/state`, `${path}/modes`];
    const isKnown = this.change?.id === this.#changeId && !isOpen(this.change ?? {});
    if (this.#changeId && !isKnown) paths.push(`/changes/${this.#changeId}`);
    const [[state, modes, change], [parameters], [why]] = await Promise.all([
      this.#answers(paths),
      this.#answers(part.kind === "node" ? [`${path}/parameters`] : []),
      this.#answers(this.#isExplained ? [`${path}/why`] : []),
      this.#renewPlan(),
    ]);
    if (this.part !== part) return;
    if (this.#isExplained) this.why = why?.blockers ? why : this.why;
    this.transitions = state.available_transitions ?? this.transitions;
    this.modes = modes.items ?? this.modes;
    this.parameters = parameters?.items ?? this.parameters;
    this.isLoaded ||= Boolean(modes.items);
    if (change?.id && change.id === this.#changeId) this.change = change;
    this.#changed();
  }

  /** A plan that would be rejected by now stays as it was shown: its request says why not. */
  async #renewPlan() {
    const { plan } = this;
    const newer = plan && (await requestPlan(plan).catch(() => plan));
    if (this.plan === plan) this.plan = newer;
  }

  /** What cannot be loaded stays as it was: the state bar shows lost contact. */
  #answers(paths) {
    return Promise.all(paths.map((path) => request("GET", path).catch(() => ({}))));
  }
}
