/** Since when each part is in its state, as far as the known events tell. */

export class StateTimes {
  #since = new Map();
  #events = null;
  #first = null;
  #newest = 0;

  /** Take the events of a state of the page; only those that are new cost anything. */
  take(events) {
    if (events === this.#events) return;
    this.#events = events;
    const ids = events.filter(({ note }) => !note);
    const [first, last] = [ids[0]?.id ?? 0, ids.at(-1)?.id ?? 0];
    // Earlier ones were loaded, or they count anew after a restart.
    if (last < this.#newest || first < this.#first) [this.#newest, this.#since] = [0, new Map()];
    for (const { id, kind, at, data } of ids)
      if (id > this.#newest && kind === "part.actual_changed") this.#since.set(data.part, Date.parse(at));
    [this.#first, this.#newest] = [first, last];
  }

  /** Return the time in ms, or null: not known, or later than the moment that is shown. */
  of(name, moment) {
    const since = this.#since.get(name);
    return since === undefined || since > moment ? null : since;
  }
}
