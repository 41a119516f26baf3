/** The token of the service: kept for this tab only, and sent with each request and to the stream. */

const KEY = "pilothouse-token";

let current = read();

/** The token, or null where none was given. */
export function token() {
  return current;
}

/** Use another token from now on; null: none. */
export function setToken(value) {
  current = value;
  try {
    if (value === null) sessionStorage.removeItem(KEY);
    else sessionStorage.setItem(KEY, value);
  } catch {
    // A browser that keeps nothing asks again after a reload.
  }
}

function read() {
  try {
    return sessionStorage.getItem(KEY);
  } catch {
    return null;
  }
}
