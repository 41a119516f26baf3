/** The keys of the timeline. */

const ZOOM = 2;

/** Return a listener; `act` is `{step(way), lane(way), pin(), pan(way), zoom(factor), begin(), now()}`. */
export function keysOf(act) {
  const keys = {
    ArrowLeft: () => act.step(-1),
    ArrowRight: () => act.step(1),
    ArrowUp: () => act.lane(-1),
    ArrowDown: () => act.lane(1),
    Enter: act.pin,
    " ": act.pin,
    PageUp: () => act.pan(-1),
    PageDown: () => act.pan(1),
    "+": () => act.zoom(ZOOM),
    "=": () => act.zoom(ZOOM),
    "-": () => act.zoom(1 / ZOOM),
    Home: act.begin,
    End: act.now,
  };
  return (event) => {
    if (event.ctrlKey || event.altKey || event.metaKey || !keys[event.key]) return;
    event.preventDefault();
    event.stopPropagation();
    keys[event.key]();
  };
}
