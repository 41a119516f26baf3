/** How the signals of a robot are named, shown and, with the mock, set. */

const percent = (value) => [String(Number((value * 100).toFixed(1))), "%"];
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
    show: (value) => [value ? "pressed" : "released", ""],
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

/** Return label, `show(value) -> [text, unit]` and control; unknown signals are shown plainly. */
export function describe(name, unit) {
  const label = name.replaceAll("_", " ");
  return CATALOG[name] ?? { label, show: (value) => [String(value), unit ?? ""], control: null };
}
