/** The colours of the style sheet for what is drawn on a canvas. */

const OF_MAP = ["ground", "grid", "axis", "ahead", "done", "trail", "aim", "vehicle", "outline"];
const OF_PAGE = ["text", "quiet", "accent", "alarm", "warn"];

/** Read the colours that hold now, by name, and a font.
 *
 * A custom property is text, such as light-dark(...), which a canvas does not understand; only as
 * the colour of an element does it become one of the present scheme.
 */
export function readInk(element) {
  const probe = element.appendChild(document.createElement("i"));
  const style = getComputedStyle(probe);
  const read = (name) => {
    probe.style.color = `var(--${name})`;
    return style.color;
  };
  const own = OF_MAP.map((name) => [name, read(`map-${name}`)]);
  const page = OF_PAGE.map((name) => [name, read(name)]);
  const font = `11px ${style.fontFamily}`;
  probe.remove();
  return { ...Object.fromEntries([...own, ...page]), font };
}

/** Call `act` when the scheme changes, by the system's setting or by the page's switch. */
export function onSchemeChange(act) {
  matchMedia("(prefers-color-scheme: dark)").addEventListener("change", act);
  new MutationObserver(act).observe(document.documentElement, { attributeFilter: ["data-theme"] });
}
