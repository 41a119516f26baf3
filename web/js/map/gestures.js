/** Turns pointers, wheel and keys into calls of `pan(dx, dy)`, `zoom(factor, x, y)` and `fit()`.
 *
 * A mouse or one finger drags; two fingers move and zoom.
 */

const STEP_PX = 40;
export const ZOOM_STEP = 1.5;

export function listen(canvas, { pan, zoom, fit }) {
  const pointers = new Map();
  const place = ({ clientX, clientY }) => {
    const box = canvas.getBoundingClientRect();
    return { x: clientX - box.left, y: clientY - box.top };
  };

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    pointers.set(event.pointerId, place(event));
    canvas.setPointerCapture(event.pointerId);
  });
  canvas.addEventListener("pointermove", (event) => {
    const before = pointers.get(event.pointerId);
    if (!before) return;
    const now = place(event);
    pointers.set(event.pointerId, now);
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1];
    if (other) pinch(other, before, now, { pan, zoom });
    else pan(now.x - before.x, now.y - before.y);
  });
  for (const end of ["pointerup", "pointercancel", "lostpointercapture"]) {
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  }
  canvas.addEventListener(
    "wheel",
    (event) => {
      event.preventDefault();
      const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? 30 : 1;
      const { x, y } = place(event);
      // A trackpad's pinch comes as small steps of a wheel with Ctrl.
      zoom(Math.exp((-event.deltaY * lines * (event.ctrlKey ? 5 : 1)) / 500), x, y);
    },
    { passive: false },
  );
  canvas.addEventListener("keydown", (event) => key(event, canvas, { pan, zoom, fit }));
}

/** Half of the way of one finger moves the middle of both; the ratio of their distances zooms. */
function pinch(other, before, now, { pan, zoom }) {
  pan((now.x - before.x) / 2, (now.y - before.y) / 2);
  const was = Math.hypot(before.x - other.x, before.y - other.y);
  const is = Math.hypot(now.x - other.x, now.y - other.y);
  if (was > 0 && is > 0) zoom(is / was, (now.x + other.x) / 2, (now.y + other.y) / 2);
}

function key(event, canvas, { pan, zoom, fit }) {
  if (event.ctrlKey || event.altKey || event.metaKey) return;
  const middle = [canvas.clientWidth / 2, canvas.clientHeight / 2];
  const moves = {
    ArrowLeft: () => pan(STEP_PX, 0),
    ArrowRight: () => pan(-STEP_PX, 0),
    ArrowUp: () => pan(0, STEP_PX),
    ArrowDown: () => pan(0, -STEP_PX),
    "+": () => zoom(ZOOM_STEP, ...middle),
    "=": () => zoom(ZOOM_STEP, ...middle),
    "-": () => zoom(1 / ZOOM_STEP, ...middle),
    0: fit,
  };
  if (!moves[event.key]) return;
  moves[event.key]();
  event.preventDefault();
}
