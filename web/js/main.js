/** Connects the stream, the store and the elements. */

import { request } from "/web/js/base/api.js";
import { localNow, ServerClock } from "/web/js/base/clock.js";
import { Connection } from "/web/js/base/connection.js";
import { Latency } from "/web/js/base/latency.js";
import { Pacer } from "/web/js/base/pacer.js";
import { partCounts } from "/web/js/base/part_problems.js";
import { PathWatch } from "/web/js/base/path_watch.js";
import { parsePlain } from "/web/js/base/plain_json.js";
import { emptyState, fold } from "/web/js/base/store.js";
import "/web/js/base/theme.js";
import "/web/js/header/token_form.js";
import "/web/js/header/version_notice.js";
import "/web/js/base/pills.js";
import "/web/js/header/replay_bar.js";
import "/web/js/header/moment_bar.js";
import "/web/js/base/hold_button.js";
import "/web/js/header/state_bar.js";
import "/web/js/header/stop_button.js";
import "/web/js/header/stop_release.js";
import "/web/js/header/notices.js";
import "/web/js/header/menu.js";
import "/web/js/header/tabs.js";
import "/web/js/header/hold_list.js";
import { goTo, listen } from "/web/js/header/keys.js";
import { showTitle } from "/web/js/header/title.js";
import "/web/js/parts/part_list.js";

const REDRAW_MS = 250;
const MOCK_PAUSE_MS = 1000;
/** So long after storage refused a request, a long press may do without it. */
const REFUSED_MS = 30_000;
/** Up to so many parts, and from so many on, the page is laid out differently. */
const [FEW, MANY] = [6, 100];

const clock = new ServerClock();
const connection = new Connection(() =>
  state.epoch === null ? null : { after: state.lastEventId, epoch: state.epoch },
);
const latency = new Latency();
const pacer = new Pacer(draw);
const pathWatch = new PathWatch(take);
const panel = document.querySelector("ph-part-panel");
const map = document.querySelector("ph-map");
const tokenForm = document.querySelector("ph-token-form");
const versionNotice = document.querySelector("ph-version-notice");
const stopButton = document.querySelector("ph-stop-button");
const elements = [
  ...document.querySelectorAll(
    "ph-stop-button, ph-stop-release, ph-state-bar, ph-replay-bar, ph-moment-bar, ph-notices, ph-tabs, #held ph-hold-list, " +
      "ph-why, ph-task-strip, ph-part-tree, ph-map, ph-part-panel, " +
      "ph-pending-list, ph-signal-list, ph-timeline, ph-what-if",
  ),
];
let state = emptyState();
let mock = {};
let selected = null;
let preview = null;
let mockAsked = false;
let refusedAt = -Infinity;
/** The moment to which the panels are pinned: `{at, state}`, time in ms; null: they show now. */
let moment = null;
let drawnLevel = null;
let panelsLoaded = null;

function take(message) {
  state = fold(state, message);
  pacer.ask(urgency(state) !== drawnLevel);
}

/** What is drawn at once when it changes: what the robot is in, and what keeps it from driving. */
function urgency({ systemState, emergencyStop, holds, task }) {
  const latch = `${emergencyStop?.engaged}${emergencyStop?.standstill_at}`;
  return [systemState?.state, systemState?.errors, Object.keys(holds), task?.status, latch].join();
}

function draw() {
  drawnLevel = urgency(state);
  const view = currentView();
  document.body.dataset.contact = view.contact.level;
  document.body.dataset.vehicle = view.state.ownDevice ? "elsewhere" : "here";
  const { total } = partCounts(view.state.parts, view.state.devices);
  document.body.dataset.size = total <= FEW ? "small" : total >= MANY ? "large" : "normal";
  // What is loaded later is not yet an element with an `update`.
  for (const element of elements) element.update?.(view);
}

function currentView() {
  const contact = {
    level: connection.level(),
    silenceMs: connection.silenceMs(),
    retryInMs: connection.retryInMs(),
    roundTripMs: latency.roundTripMs,
    skipped: connection.skipped,
  };
  selected ??= outermost(state.parts);
  // A recording goes at a speed of its own.
  const serverNow = state.replay && state.at ? Date.parse(state.at) : clock.now();
  // Without contact nobody knows whether what began before still lasts.
  const isLost = contact.level === "lost" && state.at !== null;
  const knownAt = isLost ? Date.parse(state.at) : serverNow;
  // A disk may be too slow for one request without any fault that a frame tells.
  const isRefused = performance.now() - refusedAt < REFUSED_MS;
  return {
    state: moment?.state ?? state,
    live: state,
    moment,
    enabled: contact.level !== "lost" && moment === null && !state.replay,
    contact,
    mock,
    selected,
    preview,
    serverNow: moment?.at ?? serverNow,
    knownAt: moment?.at ?? knownAt,
    volatile: isRefused || Boolean(state.systemState?.storage_fault),
    stopProgress: stopButton.progress,
  };
}

/** What is not needed to see the state and to stop the robot comes after the first draw. */
function loadPanels() {
  panelsLoaded ??= import("/web/js/panels.js").then(
    () => pacer.ask(true),
    // It is asked for again while there is contact.
    () => (panelsLoaded = null),
  );
  return panelsLoaded;
}

/** Name of the first system that no other contains; null: none is known yet. */
function outermost(parts) {
  const all = Object.values(parts);
  const owned = new Set(all.flatMap((part) => part.parts ?? []));
  return all.find(({ kind, name }) => kind === "system" && !owned.has(name))?.name ?? null;
}

/** Request what no frame carries; after a failure it is requested again on reconnection. */
async function load(paths, use) {
  try {
    use(await Promise.all(paths.map((path) => request("GET", path))));
  } catch {
    // The state bar shows lost contact; there is nothing to add here.
  }
}

/** The mock is requested only if signals are simulated; otherwise only values are shown. */
function loadMock() {
  mockAsked = false;
  if (!state.systemState?.simulated?.includes("signals")) return;
  load(["/mock"], ([{ items }]) => {
    mock = Object.fromEntries(items.map((item) => [item.signal, item]));
  });
}

/** Settings of the mock are in no frame, but each write to it is an event. */
function hearMock({ kind, data }) {
  if (mockAsked || kind !== "audit.write" || !data.path.startsWith("/mock/")) return;
  mockAsked = true;
  setTimeout(loadMock, MOCK_PAUSE_MS);
}

/** After a restart that kept the events, the stream goes on where it was cut off. */
function greet({ epoch, boot, page_version }) {
  versionNotice.compare(page_version);
  loadMock();
  const goesOn = epoch === state.epoch || (state.epoch !== null && boot > 1);
  if (!goesOn) load(["/events?limit=50"], ([log]) => take({ ...log, type: "log" }));
  panel.refresh?.();
}

/** Show the token form; the rest of the page is hidden, since it is out of date. */
function askForToken() {
  connection.stop();
  tokenForm.ask();
  watch();
}

/** What goes on without frames: ages, the title (also of a hidden page), the round trip. */
function watch() {
  const level = connection.level();
  showTitle(state, { level }, tokenForm.isOpen);
  if (level === "live") {
    latency.look();
    loadPanels();
  }
  pacer.ask(level !== document.body.dataset.contact);
}

connection.addEventListener("unauthorized", askForToken);
document.addEventListener("ph-unauthorized", askForToken);
document.addEventListener("ph-token", () => connection.tryNow());
function hear(frame, at = localNow()) {
  if (frame.type === "hello") greet(frame);
  if (frame.type === "event") hearMock(frame);
  panel.hear?.(frame);
  if (frame.type === "state") clock.observe(frame.at, at);
  const isFirst = state.systemState === null;
  take(frame);
  if (isFirst && state.systemState) loadMock();
  if (frame.type === "state") {
    map.hear?.(state);
    pathWatch.look(state);
  }
}

/** Show the frames that the page brought, which are as old as its first byte. */
function showBrought() {
  const block = document.getElementById("first-frame");
  if (block === null) return;
  const [{ responseStart }] = performance.getEntriesByType("navigation");
  const at = performance.timeOrigin + responseStart;
  for (const frame of parsePlain(block.textContent)) hear(frame, at);
  connection.heardAt(at);
  block.remove();
}

connection.addEventListener("frame", ({ detail }) => hear(detail));
document.addEventListener("ph-select", ({ detail }) => {
  selected = detail;
  draw();
  // On a slow link somebody may select a part before its panel is there: it is drawn before it can
  // have the focus.
  loadPanels().then(() => {
    panel.update?.(currentView());
    panel.bringIntoView?.();
  });
});
document.addEventListener("ph-back", () => document.querySelector("ph-part-tree").focusRow());
document.addEventListener("ph-preview", ({ detail }) => {
  preview = detail;
  pacer.ask(true);
});
document.addEventListener("ph-moment", ({ detail }) => {
  moment = detail;
  draw();
});
document.addEventListener("ph-what-if", async () => {
  await import("/web/js/what_if/drawer.js");
  draw();
  document.querySelector("ph-what-if").open();
});
document.addEventListener("ph-tab", ({ detail }) => {
  document.body.dataset.tab = detail;
  document.querySelector("main").scrollTop = 0;
  draw();
});
document.addEventListener("ph-why", () => {
  goTo("why");
  document.getElementById("why").scrollIntoView({ block: "nearest" });
});
document.addEventListener("ph-attention", () => goTo("parts"));
document.addEventListener("ph-try-now", () => {
  connection.tryNow();
  pacer.ask(true);
});
document.addEventListener("ph-storage-refused", () => {
  refusedAt = performance.now();
  pacer.ask(true);
});
document.addEventListener("ph-restart-read", () => take({ type: "restart_read" }));
document.addEventListener("ph-earlier", ({ detail }) => take({ ...detail, type: "earlier" }));
document.addEventListener("ph-replay", ({ detail }) => take({ type: "replay", replay: detail }));
document.addEventListener("ph-latch", ({ detail }) => take({ type: "latch", latch: detail }));
setInterval(watch, REDRAW_MS);
listen();
showBrought();
connection.tryNow();
// A request shows at once whether a token is needed; the stream would wait for it first.
load(["/system_state"], () => {});
requestAnimationFrame(() => setTimeout(loadPanels));
