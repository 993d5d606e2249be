// The header: which task, who holds control, what the arm does, and the stop button, which says until it is confirmed that it is not.
import { offerNamed } from "./display_names.js";
import { element } from "./elements.js";
import { stateText } from "./panels/arm_state.js";
import { patchChildren } from "./patch_children.js";
import { activeExecution, changesAny } from "./store.js";
import { formatPercent } from "./texts.js";

const NOT_STOPPED =
  "NOT STOPPED: the executor has not confirmed the stop, and the arm may be moving. Press the emergency stop of the arm. " +
  "This page goes on trying.";

/**
 * @param {Context} context
 * @param {{task: HTMLSelectElement, control: HTMLElement, arm: HTMLElement}} parts
 */
export function header({ store }, { task, control, arm }) {
  task.addEventListener("change", () => store.set({ task: task.value }));
  store.subscribe((state, changed) => {
    if (changed.has("tasks") || changed.has("task")) choose(task, state);
    if (!changesAny(changed, "executor", "connection")) return;
    patchChildren(arm, state.connection === "lost" ? null : armText(state));
    const { operator, asking } = state.executor ?? {};
    control.hidden = !operator;
    control.textContent = operator ? `${operator} has control${asking ? `, ${asking} asks for it` : ""}` : "";
  });
}

/** What the arm does, and how fast while it moves. @param {State} state @returns {Child[]} */
function armText(state) {
  const active = activeExecution(state);
  if (!state.executor) return [];
  const speed = active && active.state !== "held" ? `, ${formatPercent(active.override)}` : "";
  const { state: name } = state.executor;
  const text = active || name === "faulted" ? stateText(state.executor) : "At rest";
  return [element("span", { class: `dot ${name}` }), `${text}${speed}`];
}

/** @type {Record<import("./arm/stop.js").StopState, string>} */
const STOP_LABELS = { "": "Stop the arm", stopping: "Stopping …", "not stopped": "NOT STOPPED" };

/**
 * Let a button stop the arm; it is never disabled, for what the page knows of the arm may be out of date.
 * @param {Context} context
 * @param {import("./arm/stop.js").ArmStop} armStop
 * @param {{stop: HTMLButtonElement, warning: HTMLElement}} parts
 */
export function stopButton({ messages }, armStop, { stop, warning }) {
  stop.addEventListener("click", () => armStop.request());
  armStop.onChange = (before) => {
    const isFailing = armStop.state === "not stopped";
    stop.textContent = STOP_LABELS[armStop.state];
    stop.dataset.stop = armStop.state;
    warning.hidden = !isFailing;
    warning.textContent = isFailing ? NOT_STOPPED : "";
    if (armStop.state === "" && before === "not stopped") messages.show("The executor has confirmed the stop.");
  };
}

/** @param {HTMLSelectElement} select @param {State} state */
function choose(select, state) {
  const tasks = state.tasks ?? [];
  offerNamed(select, tasks);
  select.value = state.task;
  if (select.parentElement) select.parentElement.hidden = tasks.length === 0;
}
