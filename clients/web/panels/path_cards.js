// One card per way, with what is known of its path; and which run is shown.
import { post, resourcePath } from "../api.js";
import { closestData, codeBlock, element, hint, option, tabButton } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { changesAny } from "../store.js";
import { capitalize, pluralize } from "../texts.js";
import { markFocus, trackFocus } from "./focus.js";
import { countFresh, learn, learnButton, usableDemonstrations } from "./learning.js";
import { pathCard } from "./path_card.js";
import { PathSummaries } from "./path_summaries.js";

const BUTTONS = "[data-learn], [data-plan], [data-edit], [data-run], [data-path]";
const ABOUT_CARDS =
  "One card for each way that was shown. Choose one and certify it: that proves that the arm can follow, and lets you run it.";
const ABOUT_LEARNING =
  "Learning finds the different ways, keeps the demonstrations that agree, and fits a smooth path to each way.";
const NO_PATHS_SENTENCE =
  "Nothing to learn from yet. Show the task a few times first, each way at least three times; then learn it here, or with:";

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function pathCards(place, { store, attempt, open, readOnly }) {
  const pathSummaries = new PathSummaries(store);
  place.addEventListener("click", (event) => {
    const { learn: isLearning, plan, edit, run, path } = closestData(event, BUTTONS);
    if (isLearning) attempt(() => learn(store.state));
    if (plan) attempt(() => post(resourcePath("paths", plan, "plans")));
    const chosen = path ?? plan ?? edit ?? run;
    if (chosen) store.set({ path: chosen });
    if (edit) open("edit");
    if (run) open("run");
  });
  place.addEventListener("change", ({ target }) => {
    if (target instanceof HTMLSelectElement) store.set({ run: target.value });
  });
  trackFocus(place, store);
  const isShown = () => place.closest("[role=tabpanel][hidden]") === null;
  return {
    show: () => pathSummaries.refresh(store.state),
    update(state, changed) {
      if (isShown() && changesAny(changed, "runs", "selectedRun", "latestVersions", "jobs"))
        pathSummaries.refresh(state);
      const isNew = changesAny(changed, "runs", "selectedRun", "latestVersions", "path", "jobs", "task");
      if (isNew || changesAny(changed, "demonstrations", "pathSummaries"))
        patchChildren(place, content(state, readOnly));
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

/** @param {State} state @param {boolean} readOnly @returns {Child} */
function content(state, readOnly) {
  const { runs, task } = state;
  const run = state.selectedRun;
  const usable = usableDemonstrations(state);
  if (!run?.learned.clusters.length) {
    if (runs === null && task) return hint("The runs cannot be read yet: the service does not answer.");
    if (!usable.length) {
      return [
        hint(NO_PATHS_SENTENCE),
        codeBlock(`teachpath learn ${task || "TASK"}`),
        tabButton("demonstrate", "Show the task"),
      ];
    }
    const count = `${usable.length} ${pluralize(usable.length, "demonstration")} can be learned from.`;
    return [hint(`${count} ${ABOUT_LEARNING}`), learnButton(state, "Learn the ways")];
  }
  const fresh = countFresh(state);
  return [
    runs && runs.length > 1 && runSelect(runs, run),
    !readOnly && hint(ABOUT_CARDS),
    run.learned.notes.map((note) => element("p", { class: "note" }, capitalize(note))),
    run.learned.clusters.map((cluster) => pathCard(state, cluster, readOnly)),
    run.id === runs?.[0]?.id && fresh > 0 && hint(`${fresh} ${pluralize(fresh, "demonstration")} came after this run.`),
    !readOnly && learnButton(state, fresh > 0 ? "Learn again" : "Learn anew", fresh > 0),
  ];
}

/** @param {RunSummary[]} runs @param {Run} selected */
function runSelect(runs, selected) {
  const options = runs.map((run, i) => {
    const count = run.paths.length;
    const time = new Date(run.created_ns / 1e6).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
    const made = option(run.id, `${time}, ${count} ${pluralize(count, "way")}${i ? "" : " (newest)"}`);
    made.defaultSelected = run.id === selected.id;
    return made;
  });
  return element("label", { class: "chooser" }, "Run ", element("select", { "data-key": "runs" }, options));
}
