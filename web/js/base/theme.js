/** Light, dark, or as the system has it; the choice is kept for this browser. */

const KEPT = "pilothouse-theme";
export const THEMES = ["system", "light", "dark"];

/** The scheme that was chosen. */
export function theme() {
  const kept = read();
  return THEMES.includes(kept) ? kept : "system";
}

/** Choose a scheme, and keep the choice. */
export function setTheme(name) {
  try {
    if (name === "system") localStorage.removeItem(KEPT);
    else localStorage.setItem(KEPT, name);
  } catch {
    // Without storage it holds until the page is closed.
  }
  show(name);
}

function read() {
  try {
    return localStorage.getItem(KEPT);
  } catch {
    return null;
  }
}

function show(name) {
  if (name === "system") delete document.documentElement.dataset.theme;
  else document.documentElement.dataset.theme = name;
}

show(theme());
