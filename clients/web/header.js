// The header: which task, who holds control, and the stop button.
import { element } from "./elements.js";
import { activeExecution } from "./store.js";

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

function choose(select, state) {
  const names = (state.tasks ?? []).map((task) => task.name);
  if ([...select.options].map((option) => option.value).join("\n") !== names.join("\n")) {
    select.replaceChildren(...names.map((name) => element("option", { value: name }, name)));
  }
  select.value = state.task;
  select.parentElement.hidden = names.length === 0;
}
