/** Text files as spreadsheets and recorders write them: pure functions. */

/** The text of a file: UTF-16 if it begins with such a byte order mark, otherwise UTF-8. */
export function textOf(buffer) {
  const [first, second] = new Uint8Array(buffer, 0, Math.min(2, buffer.byteLength));
  const isWide = (first === 0xff && second === 0xfe) || (first === 0xfe && second === 0xff);
  const encoding = !isWide ? "utf-8" : first === 0xff ? "utf-16le" : "utf-16be";
  return new TextDecoder(encoding).decode(buffer);
}

/** Lines that end with LF, CRLF or CR, as the service counts them. */
export function linesOf(text) {
  return text.split(/\r\n|\r|\n/);
}
