/** <ph-pills>: the target and the actual state and mode of a part; one pill when they agree. */

import { el, renderOnce, setAttribute } from "/web/js/base/dom.js";
import { label, modeName } from "/web/js/base/words.js";

class Pills extends HTMLElement {
  show(part) {
    const { actual } = part;
    const target = part.effective_target ?? part.target;
    setAttribute(
      this,
      "data-fit",
      part.converged ? "converged" : part.change ? "changing" : "deviating",
    );
    renderOnce(this, JSON.stringify([target, actual, part.converged]), () => {
      const shown = actualPill(actual);
      const set = setter(target);
      // A system may be where its target says while its parts are not: its note tells which.
      if (part.converged || !target || label(target) === label(actual)) return [shown, ...set];
      return [
        el("span", { class: "pill target" }, hidden("target "), label(target)),
        el("span", { class: "arrow", "aria-hidden": "true" }, "→"),
        hidden("actual "),
        shown,
        ...set,
      ];
    });
  }
}

/** Who set the target in force, unless it was requested; why is its title. */
function setter(target) {
  if (!target?.because || target.because === "requested") return [];
  const title = target.blockers.map(({ message }) => message).join("; ");
  return [el("span", { class: "setter", title }, ` ${target.because} ${target.rule ?? target.reaction ?? ""}`)];
}

/** Inferred is italic with (*), as in the mode monitor of system_modes. */
function actualPill(actual) {
  if (actual.state === "unknown")
    return el("span", { class: "pill actual unknown" }, "?", hidden(" unknown"));
  const parts = [el("span", { class: actual.inferred ? "inferred" : null }, actual.state)];
  if (actual.mode)
    parts.push(el("span", { class: actual.mode_inferred ? "inferred" : null }, `.${modeName(actual.mode)}`));
  if (actual.inferred || actual.mode_inferred) {
    const title = actual.inferred ? "inferred, not reported" : "the mode is inferred, not reported";
    parts.push(el("span", { title, class: "star" }, " (*)"), hidden(" inferred"));
  }
  return el("span", { class: "pill actual" }, ...parts);
}

function hidden(text) {
  return el("span", { class: "visually-hidden" }, text);
}

customElements.define("ph-pills", Pills);
