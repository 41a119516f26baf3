/** The keys of the page. STOP has one that works everywhere, also while somebody types. */

const KEPT = "pilothouse-plain-keys";
const REGIONS = ["parts", "map", "selected", "signals", "log", "why"];
/** What a region is gone to for: the row in the list of parts, the mode of the selected part. */
const STOPS = "[role=treeitem][tabindex='0'], [role=radio][tabindex='0']:enabled";
const FOCUSABLE = "a[href], summary, button:enabled, input:enabled, select:enabled, [tabindex='0']";

/** For the list of keys: `{key, what}`. */
export const KEYS = [
  { key: "Shift+Esc", what: "STOP" },
  { key: "1", what: "Parts" },
  { key: "2", what: "Map and task" },
  { key: "3", what: "Selected part: modes" },
  { key: "4", what: "Signals" },
  { key: "5", what: "Timeline and log" },
  { key: "6", what: "Why" },
  { key: "Esc", what: "Close; back to live" },
  { key: "?", what: "This list" },
];

/** Whether keys without a modifier do something; who dictates or shakes turns them off. */
export function plainKeys() {
  try {
    return localStorage.getItem(KEPT) !== "off";
  } catch {
    return true;
  }
}

export function setPlainKeys(isOn) {
  try {
    if (isOn) localStorage.removeItem(KEPT);
    else localStorage.setItem(KEPT, "off");
  } catch {
    // Without storage there is no choice to keep.
  }
}

/** Listen for keys and for the skip links. */
export function listen() {
  // Before any element that takes Escape for itself.
  window.addEventListener("keydown", hearStop, { capture: true });
  document.addEventListener("keydown", hear);
  document.querySelector(".skip").addEventListener("click", (event) => {
    event.preventDefault();
    goTo(event.target.hash.slice(1));
  });
}

/** Show a region, on a phone its tab, and put the focus into it. */
export function goTo(name) {
  const region = document.getElementById(name);
  const tabs = region.dataset.tabs.split(" ");
  if (!tabs.includes(document.body.dataset.tab)) tell("ph-tab", tabs[0]);
  const isSeen = (node) => node.checkVisibility();
  // What above it may go, as a reason that ends, and would take the focus with it.
  const stop = [...region.querySelectorAll(STOPS)].find(isSeen);
  const target = stop ?? [...region.querySelectorAll(FOCUSABLE)].find(isSeen) ?? region;
  target.focus();
}

function hearStop(event) {
  if (event.key !== "Escape" || !event.shiftKey) return;
  event.preventDefault();
  event.stopPropagation();
  document.querySelector("ph-stop-button").engage();
}

function hear(event) {
  const isPlain = !event.ctrlKey && !event.altKey && !event.metaKey;
  if (event.defaultPrevented || !isPlain || isTyping(event.target)) return;
  if (event.key === "Escape" && document.body.hasAttribute("data-moment")) tell("ph-moment", null);
  if (!plainKeys()) return;
  const region = REGIONS[Number(event.key) - 1];
  if (event.key === "?") tell("ph-keys");
  else if (region) goTo(region);
  else return;
  event.preventDefault();
}

function isTyping(target) {
  return target.isContentEditable || target.matches("textarea, select, input:not([type=checkbox], [type=radio], [type=range])");
}

function tell(name, detail = undefined) {
  document.dispatchEvent(new CustomEvent(name, { detail }));
}
