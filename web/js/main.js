/** Connects the stream, the store and the elements. */

import { request } from "/web/js/base/api.js";
import { localNow, ServerClock } from "/web/js/base/clock.js";
import { Connection } from "/web/js/base/connection.js";
import { PathWatch } from "/web/js/base/path_watch.js";
import { robotSentence } from "/web/js/base/state_sentence.js";
import { emptyState, fold } from "/web/js/base/store.js";
import "/web/js/header/token_form.js";
import "/web/js/header/version_notice.js";
import "/web/js/base/pills.js";
import "/web/js/header/replay_bar.js";
import "/web/js/base/hold_button.js";
import "/web/js/header/acknowledge.js";
import "/web/js/inspector/alarm_list.js";
import "/web/js/inspector/reaction_list.js";
import "/web/js/header/state_bar.js";
import "/web/js/header/stop_button.js";
import "/web/js/map/map.js";
import "/web/js/header/hold_list.js";
import "/web/js/task/task_form.js";
import "/web/js/task/task_panel.js";
import "/web/js/parts/part_tree.js";
import "/web/js/inspector/mode_switcher.js";
import "/web/js/inspector/plan.js";
import "/web/js/inspector/change.js";
import "/web/js/inspector/why.js";
import "/web/js/inspector/error_list.js";
import "/web/js/inspector/part_panel.js";
import "/web/js/what_if/mock_control.js";
import "/web/js/signals/signal_list.js";
import "/web/js/timeline/event_list.js";

const REDRAW_MS = 250;
const MOCK_PAUSE_MS = 1000;
/** So long after storage refused a request, a long press may do without it. */
const REFUSED_MS = 30_000;

const clock = new ServerClock();
const connection = new Connection(() =>
  state.epoch === null ? null : { after: state.lastEventId, epoch: state.epoch },
);
const pathWatch = new PathWatch(take);
const panel = document.querySelector("ph-part-panel");
const map = document.querySelector("ph-map");
const taskPanel = document.querySelector("ph-task-panel");
const tokenForm = document.querySelector("ph-token-form");
const versionNotice = document.querySelector("ph-version-notice");
const elements = document.querySelectorAll(
  "ph-replay-bar, ph-state-bar, ph-stop-button, ph-alarm-list, ph-reaction-list, ph-task-panel, ph-part-tree, ph-map, ph-part-panel, " +
    "ph-signal-list, ph-event-list",
);
let state = emptyState();
let mock = {};
let selected = null;
let preview = null;
let drawAsked = false;
let mockAsked = false;
let refusedAt = -Infinity;
/** The moment to which the panels are pinned: `{at, state}`, time in ms; null: they show now. */
let moment = null;

function take(message) {
  state = fold(state, message);
  askToDraw();
}

/** Draw at most once per animation frame, however many frames of the stream arrive. */
function askToDraw() {
  if (drawAsked) return;
  drawAsked = true;
  requestAnimationFrame(draw);
}

function draw() {
  drawAsked = false;
  const contact = {
    level: connection.level(),
    silenceMs: connection.silenceMs(),
    retryInMs: connection.retryInMs(),
  };
  document.body.dataset.contact = contact.level;
  selected ??= Object.values(state.parts).find((part) => part.kind === "system")?.name ?? null;
  // A recording goes at a speed of its own.
  const serverNow = state.replay && state.at ? Date.parse(state.at) : clock.now();
  // Without contact nobody knows whether what began before still lasts.
  const isLost = contact.level === "lost" && state.at !== null;
  const knownAt = isLost ? Date.parse(state.at) : serverNow;
  // A disk may be too slow for one request without any fault that a frame tells.
  const isRefused = performance.now() - refusedAt < REFUSED_MS;
  const volatile = isRefused || Boolean(state.systemState?.storage_fault);
  const shown = moment?.state ?? state;
  const view = {
    state: shown,
    live: state,
    moment,
    enabled: contact.level !== "lost" && moment === null && !state.replay,
    contact,
    mock,
    selected,
    preview,
    serverNow: moment ? moment.at : serverNow,
    knownAt: moment ? moment.at : knownAt,
    volatile,
  };
  for (const element of elements) element.update(view);
}

/** The title is also visible for a hidden page, so it does not wait for an animation frame. */
function title() {
  const level = connection.level();
  const known = level === "lost" ? "No contact" : (robotSentence(state)?.word ?? "Connecting");
  if (state.replay) {
    document.title = "REPLAY · Pilothouse";
    return;
  }
  const text = `${tokenForm.isOpen ? "Token needed" : known} · Pilothouse`;
  if (document.title !== text) document.title = text;
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

/** Without example tracks there is no button for them. */
function loadTracks() {
  load(["/examples/tracks"], ([{ items }]) => (taskPanel.tracks = items));
  load(["/tasks"], ([{ controllers }]) => (taskPanel.controllers = controllers));
}

/** After a restart that kept the events, the stream goes on where it was cut off. */
function greet({ epoch, boot, page_version }) {
  versionNotice.compare(page_version);
  loadTracks();
  loadMock();
  const goesOn = epoch === state.epoch || (state.epoch !== null && boot > 1);
  if (!goesOn) load(["/events?limit=50"], ([log]) => take({ ...log, type: "log" }));
  panel.refresh();
}

/** Show the token form; the rest of the page is hidden, since it is out of date. */
function askForToken() {
  connection.stop();
  tokenForm.ask();
  title();
}

connection.addEventListener("unauthorized", askForToken);
document.addEventListener("ph-unauthorized", askForToken);
document.addEventListener("ph-token", () => connection.tryNow());
function hear(frame, at = localNow()) {
  if (frame.type === "hello") greet(frame);
  if (frame.type === "event") hearMock(frame);
  panel.hear(frame);
  if (frame.type === "state") clock.observe(frame.at, at);
  const isFirst = state.systemState === null;
  take(frame);
  if (isFirst && state.systemState) loadMock();
  if (frame.type === "state") {
    map.hear(state);
    pathWatch.look(state);
  }
  title();
}

/** Show the frames that the page brought, which are as old as its first byte. */
function showBrought() {
  const block = document.getElementById("first-frame");
  if (block === null) return;
  const [{ responseStart }] = performance.getEntriesByType("navigation");
  const at = performance.timeOrigin + responseStart;
  for (const frame of JSON.parse(block.textContent)) hear(frame, at);
  connection.heardAt(at);
  block.remove();
}

connection.addEventListener("frame", ({ detail }) => hear(detail));
document.addEventListener("ph-select", ({ detail }) => {
  selected = detail;
  draw();
  panel.bringIntoView();
});
document.addEventListener("ph-back", () => document.querySelector("ph-part-tree").focusRow());
document.addEventListener("ph-preview", ({ detail }) => {
  preview = detail;
  askToDraw();
});
document.addEventListener("ph-moment", ({ detail }) => {
  moment = detail;
  draw();
});
document.addEventListener("ph-tab", ({ detail }) => (document.body.dataset.tab = detail));
document.addEventListener("ph-try-now", () => {
  connection.tryNow();
  askToDraw();
});
document.addEventListener("ph-storage-refused", () => {
  refusedAt = performance.now();
  askToDraw();
});
document.addEventListener("ph-restart-read", () => take({ type: "restart_read" }));
document.addEventListener("ph-earlier", ({ detail }) => take({ ...detail, type: "earlier" }));
document.addEventListener("ph-replay", ({ detail }) => take({ type: "replay", replay: detail }));
document.addEventListener("ph-latch", ({ detail }) => take({ type: "latch", latch: detail }));
setInterval(askToDraw, REDRAW_MS);
setInterval(title, REDRAW_MS);
showBrought();
connection.tryNow();
// A request shows at once whether a token is needed; the stream would wait for it first.
load(["/system_state"], () => {});
