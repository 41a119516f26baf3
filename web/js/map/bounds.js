/** Bounds in the world: `{minX, minY, maxX, maxY}`, m; null is the bounds of nothing. */

/** The bounds that hold `bounds` and a place as well. */
export function include(bounds, { x_m, y_m }) {
  if (bounds === null) return { minX: x_m, minY: y_m, maxX: x_m, maxY: y_m };
  return {
    minX: Math.min(bounds.minX, x_m),
    minY: Math.min(bounds.minY, y_m),
    maxX: Math.max(bounds.maxX, x_m),
    maxY: Math.max(bounds.maxY, y_m),
  };
}

export function boundsOf(places) {
  return places.reduce(include, null);
}

export function join(one, other) {
  if (one === null || other === null) return one ?? other;
  const corner = include(one, { x_m: other.minX, y_m: other.minY });
  return include(corner, { x_m: other.maxX, y_m: other.maxY });
}

export function overlap(one, other) {
  return (
    one.minX <= other.maxX &&
    other.minX <= one.maxX &&
    one.minY <= other.maxY &&
    other.minY <= one.maxY
  );
}
