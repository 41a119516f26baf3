/** Whether two lists hold the same things, the second may be missing. */
export function isSame(one, other) {
  return one.length === other?.length && one.every((item, index) => item === other[index]);
}
