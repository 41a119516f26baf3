/** <ph-reaction-list>: the reactions of the robot, what each waits for, and whether it may act.
 *
 * Those that do something, or may not, come first; the others are folded. Arming and acknowledging
 * may set the robot in motion, so both need a long press.
 */

import { partPath, request } from "/web/js/base/api.js";
import { el, setAttribute, setText } from "/web/js/base/dom.js";
import { whileSending } from "/web/js/base/sending.js";

const ARMS = ["active", "passive", "disarmed"];

class ReactionList extends HTMLElement {
  #lines = new Map();

  connectedCallback() {
    if (this.shown) return;
    this.count = el("span", { class: "quiet" });
    this.shown = el("ul", { class: "reactions", "aria-label": "Reactions that do something" });
    this.idle = el("ul", { class: "reactions", "aria-label": "Reactions that wait" });
    this.summary = el("summary");
    this.folded = el("details", { class: "reasons-of" }, this.summary, this.idle);
    this.problem = el("p", { class: "problem", role: "alert", hidden: true });
    this.append(el("h2", {}, "Reactions ", this.count), this.shown, this.folded, this.problem);
  }

  update({ state, contact, volatile }) {
    const all = Object.entries(state.reactions);
    const calm = all.filter(([, reaction]) => isCalm(reaction));
    const others = all.filter(([, reaction]) => !isCalm(reaction));
    setAttribute(this.closest("section"), "hidden", all.length === 0);
    setAttribute(this.folded, "hidden", calm.length === 0);
    setText(this.summary, `${calm.length} waiting`);
    const acting = all.filter(([, { state }]) => state === "acting" || state === "exhausted").length;
    setText(this.count, acting ? `(${acting} acting)` : "");
    const view = { parts: state.parts ?? {}, enabled: contact.level !== "lost", volatile };
    this.#place(this.shown, others, view);
    this.#place(this.idle, calm, view);
    this.#forget(state.reactions);
  }

  /** Show reactions in order; a line that stays is moved only if it has to be. */
  #place(list, entries, view) {
    entries.forEach(([name, reaction], position) => {
      const line = this.#lines.get(name) ?? this.#made(name);
      if (list.children[position] !== line.item) {
        list.insertBefore(line.item, list.children[position] ?? null);
      }
      this.#show(line, reaction, view);
    });
  }

  #made(name) {
    const line = {
      state: el("span", { class: "severity" }),
      does: el("span"),
      waits: el("p", { class: "quiet" }),
      arm: el("select", { "aria-label": `Arm ${name}` }, ...ARMS.map((arm) => el("option", { value: arm }, arm))),
      set: el("ph-hold-button", { label: "Set (hold)", hidden: true }),
      seen: el("ph-hold-button", { label: "Acknowledge (hold)", hidden: true }),
    };
    line.arm.addEventListener("change", () => {
      line.isChosen = true;
      this.#showSet(line);
    });
    line.set.addEventListener("ph-held", () => this.#arm(line));
    line.seen.addEventListener("ph-held", ({ detail }) => this.#acknowledge(line, detail.volatile));
    line.item = el(
      "li",
      {},
      el("div", { class: "alarm-head" }, el("strong", { class: "alarm-name" }, name), line.state, line.does),
      line.waits,
      el("div", { class: "buttons" }, line.arm, line.set, line.seen),
    );
    this.#lines.set(name, line);
    return line;
  }

  #show(line, reaction, { parts, enabled, volatile }) {
    line.reaction = reaction;
    line.path = `${partPath(parts[reaction.part] ?? { kind: "node", name: reaction.part })}/reactions`;
    setAttribute(line.item, "data-state", reaction.state);
    setText(line.state, reaction.state);
    setText(line.does, doneBy(reaction));
    setText(line.waits, `waits for ${reaction.waits_for}`);
    if (!line.isChosen) line.arm.value = reaction.arm;
    line.arm.disabled = !enabled;
    this.#showSet(line);
    setAttribute(line.seen, "hidden", !needsAcknowledgement(reaction));
    for (const button of [line.set, line.seen]) {
      button.disabled = !enabled;
      button.volatile = volatile;
    }
  }

  #showSet(line) {
    setAttribute(line.set, "hidden", line.arm.value === line.reaction.arm);
  }

  #arm(line) {
    const arm = line.arm.value;
    const path = `${line.path}/${encodeURIComponent(line.reaction.reaction)}`;
    return this.#send(line.set, "Not armed", async () => {
      await request("PATCH", path, { arm, reason: "set on the page" });
      line.isChosen = false;
    });
  }

  #acknowledge(line, volatile) {
    const path = `${line.path}/${encodeURIComponent(line.reaction.reaction)}/acknowledge`;
    return this.#send(line.seen, "Not acknowledged", () =>
      request("POST", volatile ? `${path}?volatile=true` : path),
    );
  }

  #send({ button }, failed, act) {
    return whileSending(button, async () => {
      let said = "";
      try {
        await act();
      } catch ({ message }) {
        said = `${failed}: ${message}`;
      }
      setText(this.problem, said);
      setAttribute(this.problem, "hidden", said === "");
    });
  }

  #forget(known) {
    for (const [name, line] of this.#lines) {
      if (name in known) continue;
      line.item.remove();
      this.#lines.delete(name);
    }
  }
}

/** Whether nothing is to be seen of a reaction: it may act, and nothing calls for it. */
function isCalm({ state, arm }) {
  return state === "idle" && arm === "active";
}

function doneBy({ action, target, left }) {
  const label = target ? ` ${[target.state, target.mode].filter(Boolean).join(".")}` : "";
  const often = left === null ? "" : `, ${left} left`;
  return `${action.replace("_", " ")}${label}${often}`;
}

function needsAcknowledgement({ state, until }) {
  return state === "exhausted" || (until === "acknowledged" && (state === "acting" || state === "passive"));
}

customElements.define("ph-reaction-list", ReactionList);
