// The header: which task, who holds control, and the stop button.
import { option } from "./elements.js";
import { activeExecution } from "./store.js";

/**
 * @param {Context} context
 * @param {{task: HTMLSelectElement, stop: HTMLButtonElement, control: HTMLElement}} parts
 */
export function header({ store }, { task, stop, control }) {
  task.addEventListener("change", () => store.set({ task: task.value }));
  store.subscribe((state, changed) => {
    if (changed.has("tasks") || changed.has("task")) choose(task, state);
    if (!changed.has("executor")) return;
    stop.disabled = !activeExecution(state);
    const { operator, asking } = state.executor ?? {};
    control.hidden = !operator;
    control.textContent = operator ? `${operator} has control${asking ? `, ${asking} asks for it` : ""}` : "";
  });
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
