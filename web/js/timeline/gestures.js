/** Turns pointers and the wheel into calls: places are in CSS px on the canvas.
 *
 * A finger or a mouse drags along the time, two fingers zoom; up and down scrolls the page.
 */

const DRAG_PX = 4;
const WHEEL_LINE_PX = 30;

/** @param act `{point(x, y, event), leave(), press(x, y), pan(dx), zoom(factor, x)}` */
export function listen(canvas, act) {
  const pointers = new Map();
  let isDrag = false;

  canvas.addEventListener("pointerdown", (event) => {
    if (event.button !== 0) return;
    if (pointers.size === 0) isDrag = false;
    pointers.set(event.pointerId, { x: event.offsetX, start: event.offsetX });
  });
  canvas.addEventListener("pointermove", (event) => {
    const pointer = pointers.get(event.pointerId);
    if (!pointer) {
      if (event.pointerType !== "touch") act.point(event.offsetX, event.offsetY, event);
      return;
    }
    const [was, is] = [pointer.x, event.offsetX];
    if (!isDrag && pointers.size === 1 && Math.abs(is - pointer.start) < DRAG_PX) return;
    if (!isDrag) canvas.setPointerCapture(event.pointerId);
    isDrag = true;
    pointer.x = is;
    const other = [...pointers].find(([id]) => id !== event.pointerId)?.[1].x;
    if (other === undefined) act.pan(is - was);
    else pinch(act, other, was, is);
  });
  canvas.addEventListener("pointerup", (event) => {
    if (pointers.delete(event.pointerId) && !isDrag) act.press(event.offsetX, event.offsetY);
  });
  for (const end of ["pointercancel", "lostpointercapture"])
    canvas.addEventListener(end, (event) => pointers.delete(event.pointerId));
  canvas.addEventListener("pointerleave", () => act.leave());
  canvas.addEventListener("wheel", (event) => turn(event, act), { passive: false });
}

/** The wheel zooms, sideways or with Shift it moves. */
function turn(event, act) {
  event.preventDefault();
  const lines = event.deltaMode === WheelEvent.DOM_DELTA_LINE ? WHEEL_LINE_PX : 1;
  const { deltaX, deltaY, shiftKey, ctrlKey, offsetX } = event;
  if (shiftKey || Math.abs(deltaX) > Math.abs(deltaY)) act.pan(-(deltaX || deltaY) * lines);
  else act.zoom(Math.exp((-deltaY * lines * (ctrlKey ? 5 : 1)) / 500), offsetX);
}

function pinch(act, other, was, is) {
  const ratio = Math.abs(is - other) / Math.max(1, Math.abs(was - other));
  if (ratio > 0) act.zoom(ratio, (is + other) / 2);
  act.pan((is - was) / 2);
}
