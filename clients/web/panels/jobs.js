// The jobs of the task: those that run, with progress and cancel, and the last one when it failed.
import { post, resourcePath } from "../api.js";
import { closestData, element, hideSection, progressBar } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { capitalize } from "../texts.js";

/** @type {Record<string, string>} */
export const JOB_LABELS = { learn: "Learning", recut: "Cutting anew", plan: "Planning", import: "Import" };

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function jobList(place, { attempt }) {
  place.addEventListener("click", (event) => {
    const { cancel } = closestData(event);
    if (cancel) attempt(() => post(resourcePath("jobs", cancel, "cancel")));
  });
  return {
    update(state, changed) {
      if (!changed.has("jobs")) return;
      const jobs = state.jobs ?? [];
      const running = jobs.filter((job) => job.state === "running" || job.state === "queued");
      const failed = jobs.slice(0, 1).filter((job) => job.state === "failed" && job.kind !== "plan"); // a path's card says why it has no plan
      hideSection(place, !running.length && !failed.length);
      patchChildren(place, running.map(jobRow), failed.map(failedRow));
    },
  };
}

/** @param {Job} job */
function jobRow({ id, kind, message, state, fraction }) {
  const name = JOB_LABELS[kind] ?? capitalize(kind);
  return element(
    "div",
    { class: "job", "data-key": id },
    element("p", {}, `${name}: ${message || state}`),
    element("button", { type: "button", "data-cancel": id, "data-key": `cancel ${id}` }, "Cancel"),
    progressBar(fraction, name),
  );
}

/** @param {Job} job */
function failedRow({ kind, message }) {
  return element("p", { class: "job failed" }, `${JOB_LABELS[kind] ?? capitalize(kind)} failed: ${message}`);
}
