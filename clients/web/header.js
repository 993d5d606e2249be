// The header: which task, who holds control, and the stop button, which says until it is confirmed that it is not.
import { option } from "./elements.js";

const NOT_STOPPED =
  "NOT STOPPED: the executor has not confirmed the stop, and the arm may be moving. Press the emergency stop of the arm. " +
  "This page goes on trying.";

/**
 * @param {Context} context
 * @param {{task: HTMLSelectElement, control: HTMLElement}} parts
 */
export function header({ store }, { task, control }) {
  task.addEventListener("change", () => store.set({ task: task.value }));
  store.subscribe((state, changed) => {
    if (changed.has("tasks") || changed.has("task")) choose(task, state);
    if (!changed.has("executor")) return;
    const { operator, asking } = state.executor ?? {};
    control.hidden = !operator;
    control.textContent = operator ? `${operator} has control${asking ? `, ${asking} asks for it` : ""}` : "";
  });
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
  const names = (state.tasks ?? []).map((task) => task.name);
  if ([...select.options].map(({ value }) => value).join("\n") !== names.join("\n")) {
    select.replaceChildren(...names.map((name) => option(name)));
  }
  select.value = state.task;
  if (select.parentElement) select.parentElement.hidden = names.length === 0;
}
