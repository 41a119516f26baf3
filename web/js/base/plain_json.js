/** Reads what the server sends, with its texts in the words of the page. */

/** The name by itself is one that requests need; in a text an operator reads it. */
const DEFAULT_MODE = /"__DEFAULT__"|\b__DEFAULT__\b/g;

/** Parse JSON; "active.__DEFAULT__" in a text becomes "active.default".
 *
 * @throws {SyntaxError} It is not JSON.
 */
export function parsePlain(text) {
  return JSON.parse(text.replace(DEFAULT_MODE, (found) => (found.startsWith('"') ? found : "default")));
}
