/** Where the map looks: `{x_m, y_m, scale, width, height}`, all pure functions.
 *
 * `x_m, y_m` is the place in the middle, `scale` in px per m, `width, height` of the canvas in CSS
 * px. On the screen y runs downwards, in the world upwards.
 */

const MIN_SCALE = 0.01;
const MAX_SCALE = 200;
const MARGIN_PX = 42;
// A vehicle alone is shown in as much ground as this, m.
const LEAST_EXTENT_M = 14;
const FAR_SIZES = 10;

/** What is looked at before anything is known. */
export function emptyView() {
  return { x_m: 0, y_m: 0, scale: 10, width: 0, height: 0 };
}

export function toScreen(view, { x_m, y_m }) {
  return {
    x: view.width / 2 + (x_m - view.x_m) * view.scale,
    y: view.height / 2 - (y_m - view.y_m) * view.scale,
  };
}

export function toWorld(view, x, y) {
  return {
    x_m: view.x_m + (x - view.width / 2) / view.scale,
    y_m: view.y_m - (y - view.height / 2) / view.scale,
  };
}

/** The part of the world that is seen, as bounds. */
export function seen(view) {
  const { x_m: minX, y_m: maxY } = toWorld(view, 0, 0);
  const { x_m: maxX, y_m: minY } = toWorld(view, view.width, view.height);
  return { minX, minY, maxX, maxY };
}

/** Zoom so that what is under the point of the screen stays there. */
export function zoomAt(view, factor, x, y) {
  const scale = Math.min(MAX_SCALE, Math.max(MIN_SCALE, view.scale * factor));
  const { x_m, y_m } = toWorld(view, x, y);
  return {
    ...view,
    scale,
    x_m: x_m - (x - view.width / 2) / scale,
    y_m: y_m + (y - view.height / 2) / scale,
  };
}

/** Move the world by so many px of the screen. */
export function panBy(view, dx, dy) {
  return { ...view, x_m: view.x_m - dx / view.scale, y_m: view.y_m + dy / view.scale };
}

export function centred(view, { x_m, y_m }) {
  return { ...view, x_m, y_m };
}

/** Whether a place is so far from `bounds` that a view of both would show neither. */
export function isFar(bounds, { x_m, y_m }) {
  const { minX, minY, maxX, maxY } = bounds;
  const away = Math.max(minX - x_m, x_m - maxX, minY - y_m, y_m - maxY);
  return away > FAR_SIZES * Math.max(LEAST_EXTENT_M, maxX - minX, maxY - minY);
}

/** Look at all of `bounds`; without any, at the origin. */
export function fitted(view, bounds) {
  const { minX, minY, maxX, maxY } = bounds ?? { minX: 0, minY: 0, maxX: 0, maxY: 0 };
  const across = Math.max(1, view.width - 2 * MARGIN_PX);
  const down = Math.max(1, view.height - 2 * MARGIN_PX);
  const wide = across / Math.max(LEAST_EXTENT_M, maxX - minX);
  const high = down / Math.max(LEAST_EXTENT_M, maxY - minY);
  const scale = Math.min(MAX_SCALE, Math.max(MIN_SCALE, Math.min(wide, high)));
  return { ...view, scale, x_m: (minX + maxX) / 2, y_m: (minY + maxY) / 2 };
}

/** Whether a place is seen and at least `margin` (a share of the canvas) away from the edges. */
export function isWithin(view, place, margin) {
  const { x, y } = toScreen(view, place);
  const [across, down] = [view.width * margin, view.height * margin];
  return x >= across && x <= view.width - across && y >= down && y <= view.height - down;
}
