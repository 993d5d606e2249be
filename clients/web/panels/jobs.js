// The jobs of the task: those that run, with progress and cancel, and the last one when it failed.
import { at, post } from "../api.js";
import { bar, element, replace, sentence } from "../elements.js";

export const DOING = { learn: "Learning", recut: "Cutting anew", plan: "Planning" };

export function jobs(place, { attempt }) {
  place.addEventListener("click", (event) => {
    const { cancel } = event.target.closest("button")?.dataset ?? {};
    if (cancel) attempt(() => post(at("jobs", cancel, "cancel")));
  });
  return {
    update(state, changed) {
      if (!changed.has("jobs")) return;
      const all = state.jobs ?? [];
      const running = all.filter((job) => job.state === "running" || job.state === "queued");
      const failed = all.at(-1)?.state === "failed" && all.at(-1).kind !== "plan" ? [all.at(-1)] : []; // a path's card says why it has no plan
      place.parentElement.hidden = !running.length && !failed.length;
      replace(place, running.map(line), failed.map((job) => element("p", { class: "job failed" }, `${DOING[job.kind] ?? sentence(job.kind)} failed: ${job.message}`)));
    },
  };
}

function line(job) {
  const name = DOING[job.kind] ?? sentence(job.kind);
  const order = { type: "button", "data-cancel": job.id, "data-key": `cancel ${job.id}` };
  return element("div", { class: "job", "data-key": job.id }, element("p", {}, `${name}: ${job.message || job.state}`), element("button", order, "Cancel"), bar(job.fraction, name));
}
