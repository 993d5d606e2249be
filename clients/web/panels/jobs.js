// The jobs of the task: those that run, with progress and cancel, and the last one when it failed.
import { post, resourcePath } from "../api.js";
import { closestData, element, hideSection, progressBar } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { ofShownStation, StationWatch, stationLabels } from "../stations.js";
import { capitalize } from "../texts.js";

/** @type {Record<string, string>} */
export const JOB_LABELS = { learn: "Learning", recut: "Cutting anew", plan: "Planning", import: "Import" };

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function jobList(place, { attempt }) {
  place.addEventListener("click", (event) => {
    const { cancel } = closestData(event);
    if (cancel) attempt(() => post(resourcePath("jobs", cancel, "cancel")));
  });
  const watch = new StationWatch();
  return {
    update(state, changed) {
      if (!watch.hasChanged(state, changed) && !changed.has("jobs")) return;
      const jobs = ofShownStation(state, state.jobs);
      const running = jobs.filter((job) => job.state === "running" || job.state === "queued");
      const failed = jobs.slice(0, 1).filter((job) => job.state === "failed" && job.kind !== "plan"); // a path's card says why it has no plan
      const stationOf = stationLabels(state);
      hideSection(place, !running.length && !failed.length);
      patchChildren(
        place,
        running.map((job) => jobRow(job, nameOf(job, stationOf(job)))),
        failed.map((job) => failedRow(job, nameOf(job, stationOf(job)))),
      );
    },
  };
}

/** @param {Job} job @param {string} station at which it was ordered, where there are several */
const nameOf = ({ kind }, station) => `${JOB_LABELS[kind] ?? capitalize(kind)}${station && ` at ${station}`}`;

/** @param {Job} job @param {string} name */
function jobRow({ id, message, state, fraction }, name) {
  return element(
    "div",
    { class: "job", "data-key": id },
    element("p", {}, `${name}: ${message || state}`),
    element("button", { type: "button", "data-cancel": id, "data-key": `cancel ${id}` }, "Cancel"),
    progressBar(fraction, name),
  );
}

/** @param {Job} job @param {string} name */
function failedRow({ message }, name) {
  return element("p", { class: "job failed" }, `${name} failed: ${message}`);
}
