/** How the signals of a robot are named, shown and, with the mock, set. */

// Five digits that count, and never fewer than whole units.
const FIGURE = new Intl.NumberFormat("en", {
  useGrouping: false,
  maximumSignificantDigits: 5,
  maximumFractionDigits: 0,
  roundingPriority: "morePrecision",
});
/** Decimals of the units that one meets on robots, so that a number does not change its width. */
const DECIMALS = {
  "°C": 1, K: 1, mm: 0, cm: 1, m: 2, km: 2, ms: 0, s: 1, min: 1, "m/s": 2, rad: 3, "rad/s": 2, "°": 1,
  V: 2, A: 2, W: 0, Hz: 1, "1/s": 1, kg: 1, N: 1, Nm: 1, bar: 2, "%": 1, B: 0, kB: 0, MB: 0, GB: 1,
};
const LARGE = 1e4;
const MOST_DECIMALS = 6;

/** A number with the digits of its unit, more for a small one; five that count without a known unit.
 *
 * 1800.1, 0.012346, 123456.
 */
export function figure(value, unit) {
  const usual = DECIMALS[unit];
  if (usual === undefined || Math.abs(value) >= LARGE) return FIGURE.format(value);
  if (value === 0) return value.toFixed(usual);
  const needed = 1 - Math.floor(Math.log10(Math.abs(value)));
  const decimals = Math.abs(value) < 1 ? Math.max(usual, needed) : usual;
  return decimals > MOST_DECIMALS ? FIGURE.format(value) : value.toFixed(decimals);
}

/** "42.6 %", "90 %". */
const percent = (value) => [String(Math.round(value * 1000) / 10), "%"];
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
  return unit === "ratio" ? percent(value) : [figure(value, unit), unit ?? ""];
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
