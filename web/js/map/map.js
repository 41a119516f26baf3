/** <ph-map>: path, vehicle and trail on a canvas, with a description for screen readers. */

import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { include } from "/web/js/map/bounds.js";
import { drawScene } from "/web/js/map/draw.js";
import { listen, ZOOM_STEP } from "/web/js/map/gestures.js";
import { onSchemeChange, readInk } from "/web/js/map/ink.js";
import { PathShape } from "/web/js/map/path_shape.js";
import { Trail } from "/web/js/map/trail.js";
import * as looks from "/web/js/map/view.js";
import { currentTask } from "/web/js/base/store.js";
import { mapSentence, offPath, poseAge, speedWords, viewSentence } from "/web/js/base/task_words.js";

const SPOKEN_MS = 1000;

class TrackMap extends HTMLElement {
  #view = looks.emptyView();
  #mode = "fit";
  #trail = new Trail();
  #epoch = null;
  #shapes = { path: null, preview: null };
  #scene = { path: null, preview: null, runs: [], vehicle: null, isOld: false };
  #key = "";
  #ink = null;
  #drawAsked = false;
  #spokenAt = -Infinity;

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
    this.speed = el("dd");
    this.error = el("dd");
    this.age = el("p", { class: "pose-age" });
    this.follow = button("Follow", "Follow the vehicle", () => this.#setMode("follow"));
    this.fit = button("Fit", "Fit path and vehicle", () => this.#setMode("fit"));
    this.append(
      el("div", { class: "map-frame" }, this.canvas, this.age, this.words, keysLine()),
      el("div", { class: "map-foot" }, this.#readings(), this.#buttons(), touchLine()),
    );
    this.#listen();
    this.#setMode("fit");
  }

  /** Record the trail of the vehicle from each frame, since a hidden page draws none. */
  hear({ epoch, vehicle, systemState }) {
    if (epoch !== this.#epoch) this.#trail.clear();
    this.#epoch = epoch;
    if (vehicle?.at)
      this.#trail.add(vehicle.pose, Date.parse(vehicle.at), systemState?.state ?? "IDLE");
  }

  update({ state, contact, preview, serverNow }) {
    const { vehicle } = state;
    const task = currentTask(state);
    const age = poseAge(state, contact);
    const known = state.task && state.task.id === state.path?.task ? state.task : null;
    const path = this.#shape("path", known ? state.path : null);
    this.#scene = {
      path,
      split: path?.split(known.target_index, task ? (vehicle?.pose ?? null) : null) ?? null,
      target: path && task ? path.waypoint(task.target_index) : null,
      preview: this.#shape("preview", preview),
      runs: this.#trail.runs,
      vehicle,
      isOld: age !== "",
    };
    this.#look();
    this.#askIfChanged([task?.target_index, known?.id, devicePixelRatio]);
    this.#tell(state, age, serverNow);
  }

  /** Draw only if something changed: a vehicle at rest reports the same pose all the time. */
  #askIfChanged(facts) {
    const { isOld, vehicle } = this.#scene;
    const { pose, steering_angle_rad, lookahead } = vehicle ?? {};
    const seen = [isOld, pose, steering_angle_rad, lookahead, this.#trail.version, this.shown];
    const key = JSON.stringify([...facts, ...seen]);
    if (key !== this.#key) this.#ask();
    this.#key = key;
  }

  #readings() {
    return el(
      "dl",
      { class: "readings" },
      el("div", {}, el("dt", {}, "Speed"), this.speed),
      el("div", {}, el("dt", {}, "Off path"), this.error),
    );
  }

  #buttons() {
    const zoom = (factor) => () => this.#zoom(factor, this.#view.width / 2, this.#view.height / 2);
    return el(
      "div",
      { class: "buttons", role: "group", "aria-label": "Map view" },
      button("+", "Zoom in", zoom(ZOOM_STEP)),
      button("−", "Zoom out", zoom(1 / ZOOM_STEP)),
      this.fit,
      this.follow,
    );
  }

  #listen() {
    listen(this.canvas, {
      pan: (dx, dy) => this.#moved(looks.panBy(this.#view, dx, dy), "free"),
      zoom: (factor, x, y) => this.#zoom(factor, x, y),
      fit: () => this.#setMode("fit"),
    });
    new ResizeObserver(() => this.#resize()).observe(this.canvas);
    onSchemeChange(() => {
      this.#ink = null;
      this.#ask();
    });
    this.still = matchMedia("(prefers-reduced-motion: reduce)");
  }

  #zoom(factor, x, y) {
    const follows = this.#mode === "follow";
    const [px, py] = follows ? [this.#view.width / 2, this.#view.height / 2] : [x, y];
    this.#moved(looks.zoomAt(this.#view, factor, px, py), follows ? "follow" : "free");
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
    this.#ask();
  }

  /** Adapt the view to what is shown, unless the user has moved it. */
  #look() {
    const { preview, vehicle } = this.#scene;
    const pose = vehicle?.pose ?? null;
    const ids = [this.#shapes.preview?.id, this.#shapes.path?.id, pose !== null];
    const isNew = String(ids) !== this.shown;
    this.shown = String(ids);
    const shown = (preview ?? this.#scene.path)?.bounds;
    const isFar = pose !== null && Boolean(shown) && looks.isFar(shown, pose);
    const isLost = pose !== null && !isFar && !looks.isWithin(this.#view, pose, 0);
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
    const isTogether = pose && !(bounds && looks.isFar(bounds, pose));
    this.#view = looks.fit(this.#view, isTogether ? include(bounds, pose) : bounds);
  }

  #centre(margin) {
    const pose = this.#scene.vehicle?.pose;
    if (pose && !looks.isWithin(this.#view, pose, margin))
      this.#view = looks.centred(this.#view, pose);
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

  #tell(state, age, now) {
    const { vehicle } = state;
    setText(this.speed, speedWords(vehicle?.speed_mps));
    setText(this.error, offPath(currentTask(state)?.cross_track_error_m));
    setText(this.age, age);
    setAttribute(this, "data-old", age !== "");
    if (now - this.#spokenAt < SPOKEN_MS) return;
    this.#spokenAt = now;
    setText(this.words, `${mapSentence(state, age)} ${viewSentence(this.#view)}`);
  }

  #resize() {
    this.#view = {
      ...this.#view,
      width: this.canvas.clientWidth,
      height: this.canvas.clientHeight,
    };
    if (this.#mode === "fit") this.#fit();
    this.#ask();
  }

  #ask() {
    if (this.#drawAsked) return;
    this.#drawAsked = true;
    requestAnimationFrame(() => this.#draw());
  }

  #draw() {
    this.#drawAsked = false;
    const { width, height } = this.#view;
    if (width === 0 || height === 0) return;
    const ratio = devicePixelRatio;
    const [across, down] = [Math.round(width * ratio), Math.round(height * ratio)];
    // Setting the size clears a canvas, so only if it differs.
    if (this.canvas.width !== across) this.canvas.width = across;
    if (this.canvas.height !== down) this.canvas.height = down;
    this.#ink ??= readInk(this);
    drawScene(this.context, this.#view, this.#ink, ratio, this.#scene);
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

function touchLine() {
  return el("p", { class: "touch-only quiet" }, "Two fingers move and zoom the map.");
}

customElements.define("ph-map", TrackMap);
