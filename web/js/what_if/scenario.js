/** What is asked of the simulation: pure functions.
 *
 * A scenario of the page is `{signals: Map of name -> value, steps: [{t_s, ...}], until_s}`; `steps`
 * are as in `POST /simulations`.
 */

/** At most so many parts in all samples together, which is some 10 MB. */
const MOST_VIEWS = 30_000;
const SAMPLES = { least: 20, most: 240 };
const LEAST_HZ = 0.5;

/** Return the body of the request. Signals that nothing publishes are repeated as they were. */
export function scenarioBody({ signals, steps, until_s }, state, mock) {
  const parts = Math.max(1, Object.keys(state.parts).length);
  const count = Math.max(SAMPLES.least, Math.min(SAMPLES.most, Math.floor(MOST_VIEWS / parts)));
  const set = [...signals].filter(([name]) => mock[name]).map(([name, value]) => mockStep(name, value));
  const kept = readingSteps(signals, state.signals, mock);
  return {
    from: "live",
    until_s,
    sample_period_s: until_s / count,
    steps: [...set, ...kept, ...[...steps].sort((a, b) => a.t_s - b.t_s)],
  };
}

/** The index in the body of the first step that the operator has added. */
export function firstOwnStep(body, { steps }) {
  return body.steps.length - steps.length;
}

function mockStep(name, value) {
  const path = `/mock/${name.split("/").map(encodeURIComponent).join("/")}`;
  return { t_s: 0, request: { method: "PATCH", path, body: { value } } };
}

/** A reading for each rate; what was stale already stays so, unless it is set. */
function readingSteps(set, signals, mock) {
  const byRate = new Map();
  for (const [name, signal] of Object.entries(signals)) {
    const value = set.get(name) ?? (signal.stale ? null : signal.value);
    if (mock[name] || signal.settings.of || value === null) continue;
    const { stale_after_s } = signal.settings;
    const hz = stale_after_s ? Math.max(LEAST_HZ, 2 / stale_after_s) : LEAST_HZ;
    byRate.set(hz, { ...byRate.get(hz), [name]: value });
  }
  return [...byRate].map(([repeat_hz, reading]) => ({ t_s: 0, reading, repeat_hz }));
}
