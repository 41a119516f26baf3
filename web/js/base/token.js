/** The token of the service, kept for this tab only; requests and the stream send it. */

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
    // Without session storage the page asks again after a reload.
  }
}

function read() {
  try {
    return sessionStorage.getItem(KEY);
  } catch {
    return null;
  }
}
