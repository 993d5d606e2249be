// From a saved version to a certified plan, and on to where the arm is moved.
import { get, post, resourcePath } from "../api.js";
import { element, formatNumber, patchChildren, progressBar } from "../elements.js";
import { versionTitle } from "./versions.js";

export function certificationSection(place, editor) {
  const certify = element("button", { type: "button", id: "edit-certify", class: "primary" });
  const status = element("div", { id: "edit-certified", role: "status" });
  const why = element("p", { class: "note" }, "Save the version first; only what is saved is certified.");
  place.append(element("div", { class: "row" }, certify), why, status);
  let job = null; // the planning that this panel has begun: {id, path, version, plan}
  const { context } = editor;

  certify.addEventListener("click", () =>
    context.attempt(async () => {
      const { path, base } = editor.draft;
      job = { path, version: base, ...(await post(resourcePath("paths", path, "plans"), { version: base.number })) };
      render();
    }),
  );
  status.addEventListener("click", (event) => {
    if (!event.target.closest("button")) return;
    context.store.set({ path: job.path }); // its newest plan is this one
    context.open("run");
  });
  context.store.subscribe((state, changed) => {
    if (!changed.has("jobs") || !job) return;
    const now = state.jobs?.find(({ id }) => id === job.id);
    if (!now || job.plan) return;
    Object.assign(job, now);
    render();
    if (now.state === "succeeded") {
      context.attempt(async () => {
        job.plan = await get(resourcePath("plans", now.outcome));
        render();
      });
    }
  });
  const render = () => patchChildren(status, ...(job && job.path === editor.draft?.path ? content(job) : []));

  return {
    update({ draft }, what) {
      if (!draft || what === "drag" || what === "feasibility") return;
      certify.textContent = `Certify version ${versionTitle(draft.base)}`;
      certify.disabled = draft.edited;
      why.hidden = !draft.edited;
      render();
    },
  };
}

function content({ state, message, fraction, plan, version }) {
  if (state === "failed" || state === "cancelled")
    return [element("p", { class: "failed" }, `Version ${versionTitle(version)} is not certified: ${message}.`)];
  if (!plan) return [element("p", {}, message || "waiting to be planned …"), progressBar(fraction, "planning")];
  const { duration, certificate } = plan;
  const clearance =
    certificate.clearance.place === "far"
      ? "nothing near"
      : `clearance ${formatNumber(1000 * certificate.clearance.value, 0, "mm")}`;
  return [
    element(
      "p",
      { class: "good" },
      `Version ${versionTitle(version)} is certified: ${formatNumber(duration, 2, "s")}, ${clearance}.`,
    ),
    element("button", { type: "button", id: "edit-run", "data-key": "run" }, "Go to Run"),
  ];
}
