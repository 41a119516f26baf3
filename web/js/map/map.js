/** <ph-map>: path, vehicle and trail on a canvas, with a description for screen readers. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { PathWatch } from "/web/js/base/path_watch.js";
import { currentTask } from "/web/js/base/store.js";
import { mapSentence, poseAge, viewSentence } from "/web/js/base/task_words.js";
import { include } from "/web/js/map/bounds.js";
import { drawMoving, drawStill } from "/web/js/map/draw.js";
import { listen, ZOOM_STEP } from "/web/js/map/gestures.js";
import { onSchemeChange, readInk } from "/web/js/map/ink.js";
import { Layer } from "/web/js/map/layer.js";
import { Pace } from "/web/js/map/pace.js";
import { PathShape } from "/web/js/map/path_shape.js";
import { Trail } from "/web/js/map/trail.js";
import {
  centred,
  emptyView,
  fitted,
  isFar,
  isWithin,
  panBy,
  zoomAt,
} from "/web/js/map/view.js";

const SPOKEN_MS = 1000;
const HINT = "The path of a task, its waypoints and the trail of the vehicle are drawn here.";
const HINT_DROP = "Drop a CSV of waypoints to see it before it is driven.";

class TrackMap extends HTMLElement {
  #view = emptyView();
  #mode = "fit";
  #trail = new Trail();
  #epoch = null;
  #heard = null;
  #shapes = { path: null, preview: null };
  #scene = { path: null, preview: null, runs: [], vehicle: null, isOld: false };
  #seen = [];
  #key = "";
  #ink = null;
  #layer = new Layer();
  #pace = new Pace(() => this.#draw());
  #spokenAt = -Infinity;
  #isSpoken = true;
  /** The path of the task of a pinned moment, and the trail up to it. */
  #pinned = { path: null, at: null, runs: [] };
  #watch = new PathWatch((path) => {
    this.#pinned.path = path;
    this.#seen = [];
  });

  connectedCallback() {
    this.canvas = el("canvas", {
      tabindex: 0,
      role: "application",
      "aria-label": "Map",
      "aria-roledescription": "map",
      "aria-describedby": "map-words map-keys",
    });
    this.context = this.canvas.getContext("2d", { alpha: false });
    this.words = el("p", { id: "map-words", class: "visually-hidden" });
    this.age = el("p", { class: "pose-age" });
    this.hint = el("p", { class: "map-hint quiet" }, HINT, el("span", {}, HINT_DROP));
    this.follow = button("Follow", "Follow the vehicle", () => this.#setMode("follow"));
    this.fit = button("Fit", "Fit path and vehicle", () => this.#setMode("fit"));
    this.append(this.canvas, this.#buttons(), this.age, this.hint, this.words, keysLine());
    this.#listen();
    this.#setMode("fit");
  }

  /** Record the trail of the vehicle from each frame, since a hidden page draws none. */
  hear({ epoch, vehicle, systemState, task }) {
    if (epoch !== this.#epoch) this.#trail.clear();
    this.#epoch = epoch;
    if (!vehicle?.at || vehicle === this.#heard) return;
    this.#heard = vehicle;
    this.#trail.add(vehicle.pose, Date.parse(vehicle.at), trailState(systemState, task));
  }

  update({ state, live, moment, contact, preview }) {
    const path = this.#pathOf(state, live);
    const inputs = [state.vehicle, state.task, state.holds, path, preview, moment, contact.level];
    inputs.push(this.#trail.version, devicePixelRatio);
    if (inputs.some((input, index) => input !== this.#seen[index])) {
      this.#seen = inputs;
      this.#show(state, path, preview, moment, poseAge(state, contact));
    }
    this.#speak(state, contact);
  }

  #show(state, path, preview, moment, age) {
    const { vehicle } = state;
    const task = currentTask(state);
    const shape = this.#shape("path", path);
    this.#scene = {
      path: shape,
      split: shape?.split(state.task.target_index, task ? (vehicle?.pose ?? null) : null) ?? null,
      target: shape && task ? targetOf(shape, task) : null,
      preview: this.#shape("preview", preview),
      runs: this.#runsUntil(moment?.at ?? null),
      vehicle,
      controller: task?.controller ?? null,
      isOld: age !== "",
    };
    this.#look();
    this.#askIfChanged([task?.target_index, moment?.at, devicePixelRatio]);
    setText(this.age, age);
    setAttribute(this.hint, "hidden", shape !== null || preview !== null);
    this.#isSpoken = false;
  }

  /** The path of the task that is shown; that of an earlier moment is loaded. */
  #pathOf(state, live) {
    const id = state.task?.id;
    if (!id) return null;
    const known = [state.path, live.path, this.#pinned.path].find((path) => path?.task === id);
    if (!known && state !== live) this.#watch.look({ task: state.task, path: null });
    return known ?? null;
  }

  /** The trail up to a pinned moment; null: all of it. */
  #runsUntil(at) {
    if (this.#pinned.at !== at) {
      const runs = at === null ? [] : this.#trail.until(at);
      Object.assign(this.#pinned, { at, runs });
    }
    return at === null ? this.#trail.runs : this.#pinned.runs;
  }

  /** Draw only if something changed: a vehicle at rest reports the same pose all the time. */
  #askIfChanged(facts) {
    const { isOld, vehicle } = this.#scene;
    const { pose, steering_angle_rad, lookahead } = vehicle ?? {};
    const seen = [isOld, pose, steering_angle_rad, lookahead, this.#trail.version, this.shown];
    const key = JSON.stringify([...facts, ...seen]);
    if (key !== this.#key) this.#pace.soon();
    this.#key = key;
  }

  #buttons() {
    const zoom = (factor) => () => this.#zoom(factor, this.#view.width / 2, this.#view.height / 2);
    return el(
      "div",
      { class: "map-buttons", role: "group", "aria-label": "Map view" },
      button("+", "Zoom in", zoom(ZOOM_STEP)),
      button("−", "Zoom out", zoom(1 / ZOOM_STEP)),
      this.fit,
      this.follow,
    );
  }

  #listen() {
    listen(this.canvas, {
      pan: (dx, dy) => this.#moved(panBy(this.#view, dx, dy), "free"),
      zoom: (factor, x, y) => this.#zoom(factor, x, y),
      fit: () => this.#setMode("fit"),
    });
    new ResizeObserver(() => this.#resize()).observe(this.canvas);
    onSchemeChange(() => {
      this.#ink = null;
      this.#pace.now();
    });
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
  }

  #zoom(factor, x, y) {
    const follows = this.#mode === "follow";
    const [px, py] = follows ? [this.#view.width / 2, this.#view.height / 2] : [x, y];
    this.#moved(zoomAt(this.#view, factor, px, py), follows ? "follow" : "free");
  }

  #moved(view, mode) {
    this.#view = view;
    this.#setMode(mode);
  }

  #setMode(mode) {
    const isNew = mode !== this.#mode;
    this.#mode = mode;
    for (const name of ["fit", "follow"])
      setAttribute(this[name], "aria-pressed", String(name === mode));
    if (mode === "fit") this.#fit();
    if (mode === "follow" && isNew) this.#centre(0.5);
    this.#isSpoken = false;
    this.#pace.now();
  }

  /** Adapt the view to what is shown, unless the user has moved it. */
  #look() {
    const { preview, vehicle } = this.#scene;
    const pose = vehicle?.pose ?? null;
    const ids = [this.#shapes.preview?.id, this.#shapes.path?.id, pose !== null];
    const isNew = String(ids) !== this.shown;
    this.shown = String(ids);
    const shown = (preview ?? this.#scene.path)?.bounds;
    const isApart = pose !== null && Boolean(shown) && isFar(shown, pose);
    const isLost = pose !== null && !isApart && !isWithin(this.#view, pose, 0);
    if (preview && isNew) this.#setMode("fit");
    else if (this.#mode === "fit" && (isNew || isLost)) this.#fit();
    // With reduced motion the ground stays still until the vehicle approaches an edge.
    else if (this.#mode === "follow") this.#centre(this.still.matches ? 0.25 : 0.5);
  }

  #fit() {
    const { preview, path, vehicle } = this.#scene;
    const bounds = (preview ?? path)?.bounds ?? null;
    const pose = vehicle?.pose;
    // A track of another place, as in coordinates of a map, is shown alone.
    const isTogether = pose && !(bounds && isFar(bounds, pose));
    this.#view = fitted(this.#view, isTogether ? include(bounds, pose) : bounds);
  }

  #centre(margin) {
    const pose = this.#scene.vehicle?.pose;
    if (pose && !isWithin(this.#view, pose, margin))
      this.#view = centred(this.#view, pose);
  }

  /** A path is prepared for drawing once; `items` are never changed in place. */
  #shape(name, path) {
    if (path === null) this.#shapes[name] = null;
    else if (this.#shapes[name]?.items !== path.items) {
      const shape = new PathShape(path.items, path.indices);
      this.#shapes[name] = { items: path.items, shape, id: ++shapesMade };
    }
    return this.#shapes[name]?.shape ?? null;
  }

  /** Tell those who do not see the map, at most once a second. */
  #speak(state, contact) {
    const now = performance.now();
    if (this.#isSpoken || now - this.#spokenAt < SPOKEN_MS) return;
    this.#isSpoken = true;
    this.#spokenAt = now;
    const seen = this.#view.width > 0 ? ` ${viewSentence(this.#view)}` : "";
    setText(this.words, mapSentence(state, poseAge(state, contact)) + seen);
  }

  #resize() {
    this.#view = {
      ...this.#view,
      width: this.canvas.clientWidth,
      height: this.canvas.clientHeight,
    };
    if (this.#mode === "fit") this.#fit();
    this.#isSpoken = false;
    this.#pace.now();
  }

  #draw() {
    const { width, height } = this.#view;
    if (width === 0 || height === 0) return;
    const ratio = devicePixelRatio;
    const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
    // Setting the size clears a canvas, so only if it differs.
    if (this.canvas.width !== across) this.canvas.width = across;
    if (this.canvas.height !== down) this.canvas.height = down;
    this.#ink ??= readInk(this);
    const [view, ink, scene] = [this.#view, this.#ink, this.#scene];
    this.#layer.paint(this.context, this.#stillKey(), (context) =>
      drawStill(context, view, ink, ratio, scene),
    );
    drawMoving(this.context, view, ink, ratio, scene);
  }

  /** What the picture of all that rests depends on. */
  #stillKey() {
    const { path, preview, split } = this.#scene;
    const piece = path?.pieceOf(split.segment).first;
    const marks = preview ? this.#shapes.preview.id : null;
    const trail = [this.#pinned.at, this.#trail.settled];
    const { x_m, y_m, scale } = this.#view;
    const facts = [x_m, y_m, scale, this.#shapes.path?.id, piece, marks, trail, this.#ink.ground];
    return JSON.stringify(facts);
  }
}

let shapesMade = 0;

function button(text, name, act) {
  return el("button", { type: "button", "aria-label": name, title: name, onclick: act }, text);
}

function keysLine() {
  const keys = "Arrow keys move, plus and minus zoom, 0 fits.";
  return el("p", { id: "map-keys", class: "visually-hidden" }, keys);
}

/** What the vehicle did, for the colour of its trail. */
function trailState(systemState, task) {
  if (systemState?.state === "ERROR") return "ERROR";
  if (task?.status === "PAUSED" || task?.status === "PAUSING") return "HELD";
  return systemState?.state ?? "IDLE";
}

function targetOf(shape, { target_index, waypoint_count }) {
  const index = Math.min(target_index, waypoint_count - 1);
  return { index, place: shape.waypoint(index) };
}

customElements.define("ph-map", TrackMap);
