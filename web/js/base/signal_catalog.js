/** How the signals of a robot are named, shown and, with the mock, set. */

// Five digits that count, and never fewer than whole units.
const FIGURE = new Intl.NumberFormat("en", {
  useGrouping: false,
  maximumSignificantDigits: 5,
  maximumFractionDigits: 0,
  roundingPriority: "morePrecision",
});

/** A number with as many digits as one can use: 1800.1, 0.012346, 123456. */
export function figure(value) {
  return FIGURE.format(value);
}

const percent = (value) => [figure(value * 100), "%"];
const fixed = (digits, unit) => (value) => [value.toFixed(digits), unit];
const words = (value) => [String(value).toLowerCase().replaceAll("_", " "), ""];

const CATALOG = {
  battery_level: {
    label: "Battery",
    show: percent,
    control: { kind: "range", min: 0, max: 1, step: 0.01 },
  },
  estop: {
    label: "E-stop signal",
    show: (value) => [value ? "pressed" : "not pressed", ""],
    control: { kind: "switch", label: "Pressed" },
  },
  gps_accuracy: {
    label: "GPS accuracy",
    show: fixed(0, "mm"),
    control: { kind: "range", min: 0, max: 300, step: 1 },
  },
  signal_strength: {
    label: "Radio signal",
    show: words,
    control: { kind: "select", options: ["CONNECTED", "LOW_SIGNAL", "NOT_CONNECTED"] },
  },
  temperature: {
    label: "Temperature",
    show: fixed(1, "°C"),
    control: { kind: "range", min: 0, max: 100, step: 0.5 },
  },
};

/** Return label, `show(value) -> [text, unit]` and control of a signal. */
export function describe(name, { value, unit, settings = {} }) {
  if (CATALOG[name]) return CATALOG[name];
  const label = capitalised(settings.label || name.replaceAll("_", " "));
  return {
    label,
    show: (shown) => plainly(shown, unit),
    control: controlOf(value, settings),
  };
}

/** The value with its unit as one text; "?" for one that is unknown. */
export function valueText(name, signal, value) {
  if (value === null || value === undefined) return "?";
  return describe(name, signal).show(value).join(" ").trimEnd();
}

function capitalised(text) {
  return text.charAt(0).toUpperCase() + text.slice(1);
}

function plainly(value, unit) {
  if (typeof value === "boolean") return [value ? "yes" : "no", ""];
  if (typeof value !== "number") return words(value);
  return unit === "ratio" ? percent(value) : [figure(value), unit ?? ""];
}

/** A number can be set around its threshold, within its limits. */
function controlOf(value, { threshold, minimum, maximum, members }) {
  if (members) return { kind: "select", options: members.split(", ") };
  if (typeof value === "boolean") return { kind: "switch", label: "On" };
  const far = 2 * Math.max(Math.abs(threshold ?? 0), Math.abs(value ?? 0)) || 1;
  const min = minimum ?? ((threshold ?? 0) < 0 || (value ?? 0) < 0 ? -far : 0);
  const max = maximum ?? far;
  return { kind: "range", min, max, step: 10 ** Math.floor(Math.log10((max - min) / 50)) };
}
