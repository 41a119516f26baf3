/** Controls that set the value of one signal: a slider, a choice or a switch. */

import { el } from "/web/js/base/dom.js";

/** Make the control that `describe` names; returns `{node, field, read, write}`. */
export function makeInput(control, label) {
  if (control.kind === "range") {
    const { min, max, step } = control;
    const field = el("input", { type: "range", min, max, step, "aria-label": `${label}: set` });
    return {
      node: field,
      field,
      read: () => field.valueAsNumber,
      write: (value) => (field.valueAsNumber = value),
    };
  }
  if (control.kind === "select") {
    const options = control.options.map((value) => el("option", { value }, optionWords(value)));
    const field = el("select", { "aria-label": `${label}: set` }, ...options);
    return { node: field, field, read: () => field.value, write: (value) => (field.value = value) };
  }
  const { node, box } = makeSwitch(control.label, `${label}: ${control.label.toLowerCase()}`);
  return { node, field: box, read: () => box.checked, write: (value) => (box.checked = value) };
}

/** Make a switch; `name` is what it is called where its text alone says too little. */
export function makeSwitch(text, name) {
  const box = el("input", { type: "checkbox", role: "switch", "aria-label": name });
  return { box, node: el("label", { class: "switch" }, box, el("span", {}, text)) };
}

function optionWords(value) {
  return value.toLowerCase().replaceAll("_", " ");
}
