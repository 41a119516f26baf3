/** Creates and changes elements. Text from the network is only used for text nodes. */

/** Make an element; `props` are attributes, or listeners where the name begins with "on". */
export function el(tag, props = {}, ...children) {
  const node = document.createElement(tag);
  for (const [name, value] of Object.entries(props)) {
    if (name.startsWith("on")) node.addEventListener(name.slice(2), value);
    else setAttribute(node, name, value);
  }
  node.append(...children.filter((child) => child !== null));
  return node;
}

/** Set an attribute if it differs; null and false take it away, true leaves it empty. */
export function setAttribute(node, name, value) {
  if (value === null || value === undefined || value === false) {
    if (node.hasAttribute(name)) node.removeAttribute(name);
    return;
  }
  const text = value === true ? "" : String(value);
  if (node.getAttribute(name) !== text) node.setAttribute(name, text);
}

/** Set the text if it differs, so that an unchanged node costs no layout. */
export function setText(node, text) {
  if (node.textContent !== text) node.textContent = text;
}

/** Run `build` and replace the children only when `key` differs from the last time. */
export function renderOnce(node, key, build) {
  if (node.renderedKey === key) return;
  node.renderedKey = key;
  node.replaceChildren(...build());
}

const PATHS = {
  idle: "M7 7h10v10H7z",
  paused: "M9 7v10M15 7v10",
  stopping: "M9 7v10M15 7v10M3 21h18",
  done: "M12 3a9 9 0 1 0 .01 0M8 12.3l2.8 2.8L16 9.5",
  canceled: "M12 3a9 9 0 1 0 .01 0M8 12h8",
  held: "M5.5 11h13v9.5h-13zM8.5 11V8a3.5 3.5 0 0 1 7 0v3",
  aborted: "M12 3a9 9 0 1 0 .01 0M8.5 8.5l7 7M15.5 8.5l-7 7",
  menu: "M4 7h16M4 12h16M4 17h16",
  running: "M8 6l10 6-10 6z",
  error: "M12 3.5L22 20.5H2zM12 10v5M12 17.6v.4",
  lost: "M3 3l18 18M5 12a10 10 0 0 1 4-2.6M19 12a10 10 0 0 0-5-3M8.5 15.5a5 5 0 0 1 5-1.3M12 19v.2",
  status: "M4 13h4l2.5-7 4 13L17 13h3.5",
  map: "M3.5 6.5l5.5-2 6 2 5.5-2v13l-5.5 2-6-2-5.5 2zM9 4.5v13M15 6.5v13",
  parts: "M4 6.5h3M4 12h3M4 17.5h3M10.5 6.5H20M10.5 12H20M10.5 17.5H20",
  signals: "M5 19v-5M10 19V9M15 19v-8M20 19V5",
  log: "M12 3.5a8.5 8.5 0 1 0 .01 0M12 8v4.5l3 2",
  late: "M12 3a9 9 0 1 0 .01 0M12 7v5l3.5 2",
};

/** Make an icon that repeats the text beside it, hidden from screen readers. */
export function icon(name) {
  const space = "http://www.w3.org/2000/svg";
  const svg = document.createElementNS(space, "svg");
  svg.setAttribute("viewBox", "0 0 24 24");
  svg.setAttribute("aria-hidden", "true");
  svg.setAttribute("class", "icon");
  const path = document.createElementNS(space, "path");
  path.setAttribute("d", PATHS[name]);
  svg.append(path);
  return svg;
}
