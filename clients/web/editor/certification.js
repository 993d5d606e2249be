// From a saved version to a certified plan, and on to where the arm is moved.
import { get, post, resourcePath } from "../api.js";
import { block, closest, element, progressBar } from "../elements.js";
import { icon } from "../icons.js";
import { newestPlanning } from "../panels/path_summaries.js";
import { patchChildren } from "../patch_children.js";
import { formatLength, formatNumber } from "../texts.js";
import { versionTitle } from "./versions.js";

export const UNSAVED_SENTENCE = "Save the version first; only what is saved is certified.";

/** @typedef {Job & {path: string, version: import("./draft.js").BaseVersion, plan?: Plan}} Planning */

/** Whether what is edited is a certified version, as it was saved. @param {Editor} editor */
export function isCertified({ draft, context }) {
  if (!draft || draft.edited) return false;
  const version = { id: draft.path, version: draft.base.number };
  return newestPlanning(version, context.store.state.jobs ?? [])?.state === "succeeded";
}

/** @param {HTMLElement} place @param {Editor} editor @param {HTMLElement} foot where its button goes @returns {EditorSection} */
export function certificationSection(place, editor, foot) {
  const certify = element("button", { type: "button", id: "edit-certify" });
  const status = element("div", { id: "edit-certified", role: "status" });
  const why = element("p", { class: "note" }, UNSAVED_SENTENCE);
  place.append(why, status);
  foot.append(certify);
  /** @type {Planning | null} */
  let job = null; // that is followed
  const { context } = editor;

  certify.addEventListener("click", () =>
    context.attempt(async () => {
      if (!editor.draft) return;
      const { path, base } = editor.draft;
      const begun = await post(resourcePath("paths", path, "plans"), { version: base.number });
      editor.followPlanning({ path, version: base, ...begun });
    }),
  );
  status.addEventListener("click", (event) => {
    if (!closest(event, "button") || !job) return;
    context.store.set({ path: job.path }); // its newest plan is this one
    context.open("run");
  });
  const showPrimary = () => certify.classList.toggle("primary", !isCertified(editor)); // what is done is no next step
  context.store.subscribe((state, changed) => {
    if (changed.has("jobs")) showPrimary();
    if (!changed.has("jobs") || !job || job.plan) return;
    const planning = job;
    const now = state.jobs?.find(({ id }) => id === planning.id);
    if (!now) return;
    Object.assign(planning, now);
    render();
    if (now.state !== "succeeded") return;
    context.attempt(async () => {
      planning.plan = await get(resourcePath("plans", now.outcome));
      render();
    });
  });
  const render = () => patchChildren(status, ...(job && job.path === editor.draft?.path ? content(job) : []));

  return {
    update({ draft, planning }, what) {
      if (what === "planning") {
        job = planning;
        render();
      }
      if (!draft || what === "drag" || what === "feasibility") return;
      certify.replaceChildren(icon("certify"), `Certify version ${draft.base.number}`);
      block(certify, draft.edited ? UNSAVED_SENTENCE : "");
      showPrimary();
      why.hidden = !draft.edited;
      render();
    },
  };
}

/** @param {Planning} planning @returns {Child[]} */
function content({ state, message, fraction, plan, version }) {
  if (state === "failed" || state === "cancelled")
    return [element("p", { class: "failed" }, `Version ${versionTitle(version)} is not certified: ${message}.`)];
  if (!plan) return [element("p", {}, message || "waiting to be planned …"), progressBar(fraction, "planning")];
  const { duration, certificate } = plan;
  const clearance =
    certificate.clearance.place === "far" ? "nothing near" : `clearance ${formatLength(certificate.clearance.value)}`;
  return [
    element(
      "p",
      { class: "good" },
      `Version ${versionTitle(version)} is certified: ${formatNumber(duration, 2, "s")}, ${clearance}.`,
    ),
    element("button", { type: "button", id: "edit-run", "data-key": "run" }, "Go to Run"),
  ];
}
