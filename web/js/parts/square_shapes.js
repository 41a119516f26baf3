/** Geometry of the grid of squares: pure functions, in units of one cell. */

const FEWEST_COLUMNS = 26;
const MOST_COLUMNS = 74;
/** Width by height of the place for which the columns are chosen. */
const ASPECT = 296 / 170;

/** Shapes tell apart what colours do, drawn from the upper left corner of a cell. */
const SHAPES = {
  normal: "m.14.14h.72v.72h-.72z",
  changing: "m.14.14h.72v.72h-.72zm.2.2v.32h.32v-.32z",
  unknown: "m.14.14h.72v.72h-.72zm.12.12v.48h.48v-.48z",
  warned: "m.5.02l.5.94h-1z",
  deviating: "m.5.02l.5.94h-1z",
  faulty: "m.5-.06l.56.56l-.56.56l-.56-.56z",
  unreachable: "m.02.18l.16-.16l.32.32l.32-.32l.16.16l-.32.32l.32.32l-.16.16l-.32-.32l-.32.32l-.16-.16l.32-.32z",
};
export const SQUARE_LOOKS = Object.keys(SHAPES);

/** Return how many columns let so many squares fill their place. */
export function columnsFor(count) {
  return Math.min(MOST_COLUMNS, Math.max(FEWEST_COLUMNS, Math.ceil(Math.sqrt(count * ASPECT))));
}

/** Return for each look one path with all its squares; `looks` has that of each square. */
export function squarePaths(looks, columns) {
  const paths = Object.fromEntries(SQUARE_LOOKS.map((look) => [look, []]));
  looks.forEach((look, at) =>
    paths[look].push(`M${at % columns} ${Math.floor(at / columns)}${SHAPES[look]}`),
  );
  return Object.fromEntries(Object.entries(paths).map(([look, all]) => [look, all.join("")]));
}

/** Return which square is at a place in cells, or -1. */
export function squareAt(x, y, columns, count) {
  if (x < 0 || x >= columns || y < 0) return -1;
  const at = Math.floor(y) * columns + Math.floor(x);
  return at < count ? at : -1;
}
