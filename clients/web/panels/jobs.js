// The jobs of the task: those that run, with progress and cancel, and the last one when it failed.
import { post, resourcePath } from "../api.js";
import { capitalize, element, patchChildren, progressBar } from "../elements.js";

export const JOB_LABELS = { learn: "Learning", recut: "Cutting anew", plan: "Planning" };

export function jobList(place, { attempt }) {
  place.addEventListener("click", (event) => {
    const { cancel } = event.target.closest("button")?.dataset ?? {};
    if (cancel) attempt(() => post(resourcePath("jobs", cancel, "cancel")));
  });
  return {
    update(state, changed) {
      if (!changed.has("jobs")) return;
      const all = state.jobs ?? [];
      const running = all.filter((job) => job.state === "running" || job.state === "queued");
      const failed = all.at(-1)?.state === "failed" && all.at(-1).kind !== "plan" ? [all.at(-1)] : []; // a path's card says why it has no plan
      place.parentElement.hidden = !running.length && !failed.length;
      patchChildren(
        place,
        running.map(jobRow),
        failed.map((job) =>
          element(
            "p",
            { class: "job failed" },
            `${JOB_LABELS[job.kind] ?? capitalize(job.kind)} failed: ${job.message}`,
          ),
        ),
      );
    },
  };
}

function jobRow(job) {
  const name = JOB_LABELS[job.kind] ?? capitalize(job.kind);
  const order = { type: "button", "data-cancel": job.id, "data-key": `cancel ${job.id}` };
  return element(
    "div",
    { class: "job", "data-key": job.id },
    element("p", {}, `${name}: ${job.message || job.state}`),
    element("button", order, "Cancel"),
    progressBar(job.fraction, name),
  );
}
