/** A path made ready for drawing: pieces with a Path2D each, of which only those seen are drawn. */

import { boundsOf, join } from "/web/js/map/bounds.js";

// So short that the piece the vehicle is on can be made anew for each picture.
const POINTS_OF_A_PIECE = 32;

export class PathShape {
  /** `indices` tell which waypoint each item is; left out, the items are all waypoints. */
  constructor(items, indices = items.map((_, index) => index)) {
    this.items = items;
    this.indices = indices;
    // Path2D counts in single precision, so places are counted from the first one.
    [this.origin] = items;
    this.start = items[0];
    this.end = items.at(-1);
    this.pieces = [...pieces(this)];
    this.bounds = this.pieces.map(({ bounds }) => bounds).reduce(join, null);
    /** Mean distance of neighbours, m. */
    this.spacing_m = lengthOf(items) / (items.length - 1);
  }

  /** The piece that has that segment. */
  pieceOf(segment) {
    return this.pieces[Math.floor(segment / POINTS_OF_A_PIECE)];
  }

  /** The waypoint of that number; of a thinned path the next one that was kept. */
  waypoint(index) {
    return this.items[Math.min(this.#position(index), this.items.length - 1)];
  }

  /** Where the part that is done ends: `{segment, place}`, the segment counted by its first item.
   *
   * That is beside the vehicle, on the segments between the kept waypoints around the target.
   */
  split(targetIndex, pose) {
    const segment = Math.min(Math.max(0, this.#position(targetIndex) - 1), this.items.length - 2);
    const [from, to] = [this.items[segment], this.items[segment + 1]];
    if (targetIndex <= this.indices[0]) return { segment, place: from };
    const [dx, dy] = [to.x_m - from.x_m, to.y_m - from.y_m];
    const square = dx * dx + dy * dy;
    if (pose === null || square === 0) return { segment, place: from };
    const along = ((pose.x_m - from.x_m) * dx + (pose.y_m - from.y_m) * dy) / square;
    const share = Math.min(1, Math.max(0, along));
    return { segment, place: { x_m: from.x_m + share * dx, y_m: from.y_m + share * dy } };
  }

  /** A Path2D through places, counted from the origin. */
  shapeOf(places) {
    const shape = new Path2D();
    const { x_m, y_m } = this.origin;
    places.forEach((place, index) => {
      if (index === 0) shape.moveTo(place.x_m - x_m, place.y_m - y_m);
      else shape.lineTo(place.x_m - x_m, place.y_m - y_m);
    });
    return shape;
  }

  /** Position among the items of the first one that is waypoint `index` or later. */
  #position(index) {
    let [low, high] = [0, this.indices.length];
    while (low < high) {
      const middle = (low + high) >> 1;
      if (this.indices[middle] < index) low = middle + 1;
      else high = middle;
    }
    return low;
  }
}

/** Neighbours share a point; `before_m` is the length of the path up to the piece. */
function* pieces(path) {
  let before_m = 0;
  for (let first = 0; first < path.items.length - 1; first += POINTS_OF_A_PIECE) {
    const places = path.items.slice(first, first + POINTS_OF_A_PIECE + 1);
    const last = first + places.length - 1;
    yield { first, last, before_m, shape: path.shapeOf(places), bounds: boundsOf(places) };
    before_m += lengthOf(places);
  }
}

/** Length of the line through places, m. */
export function lengthOf(places) {
  let length = 0;
  for (let index = 1; index < places.length; index += 1) {
    const [from, to] = [places[index - 1], places[index]];
    length += Math.hypot(to.x_m - from.x_m, to.y_m - from.y_m);
  }
  return length;
}
