// Run: what the arm does.
import { bar, element, facts, hint, number, percent, replace, section, sentence } from "../elements.js";

let arm;

export const panel = {
  id: "run",
  title: "Run",

  mount(place) {
    arm = section(place, "arm", "Arm");
  },

  update(state, changed) {
    if (!["executor", "executions"].some((name) => changed.has(name))) return;
    const newest = state.executions?.[0]?.status;
    const status = state.executor?.execution ? state.executor : newest;
    replace(arm, status ? content(status) : hint(state.executions ? "At rest. Nothing has been executed yet." : "The service does not answer."));
  },
};

function content(status) {
  return [
    element("p", { class: "state" }, element("span", { class: `dot ${status.state}` }), sentence(status.state), status.reason && `: ${status.reason}`),
    bar(status.progress, "progress along the path"),
    facts([
      ["Speed", percent(status.override)],
      ["Duration", status.duration > 0 && number(status.duration, 1, "s")],
      ["Largest tracking error", status.tracking_error > 0 && number(status.tracking_error * 1000, 2, "mrad")],
      ["Largest limit use", status.limit_use > 0 && percent(status.limit_use)],
      ["Setpoints late, missed", status.cycles > 0 && `${status.late}, ${status.missed} of ${number(status.cycles, 0)}`],
    ]),
  ];
}
