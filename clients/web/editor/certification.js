// From a saved version to a certified plan, and on to where the arm is moved.
import { at, get, post } from "../api.js";
import { bar, element, number, replace } from "../elements.js";
import { title } from "./versions.js";

export function certifying(place, editor) {
  const certify = element("button", { type: "button", id: "edit-certify", class: "primary" });
  const told = element("div", { id: "edit-certified", role: "status" });
  const why = element("p", { class: "note" }, "Save the version first; only what is saved is certified.");
  place.append(element("div", { class: "row" }, certify), why, told);
  let job = null; // the planning that this panel has begun: {id, path, version, plan}
  const { context } = editor;

  certify.addEventListener("click", () =>
    context.attempt(async () => {
      const { path, base } = editor.draft;
      job = { path, version: base, ...(await post(at("paths", path, "plans"), { version: base.number })) };
      tell();
    }),
  );
  told.addEventListener("click", (event) => {
    if (!event.target.closest("button")) return;
    context.store.set({ path: job.path }); // its newest plan is this one
    context.open("run");
  });
  context.store.subscribe((state, changed) => {
    if (!changed.has("jobs") || !job) return;
    const now = state.jobs?.find(({ id }) => id === job.id);
    if (!now || job.plan) return;
    Object.assign(job, now);
    tell();
    if (now.state === "succeeded") {
      context.attempt(async () => {
        job.plan = await get(at("plans", now.outcome));
        tell();
      });
    }
  });
  const tell = () => replace(told, ...(job && job.path === editor.draft?.path ? content(job) : []));

  return {
    update({ draft }, what) {
      if (!draft || what === "drag" || what === "verdict") return;
      certify.textContent = `Certify version ${title(draft.base)}`;
      certify.disabled = draft.edited;
      why.hidden = !draft.edited;
      tell();
    },
  };
}

function content({ state, message, fraction, plan, version }) {
  if (state === "failed" || state === "cancelled") return [element("p", { class: "failed" }, `Version ${title(version)} is not certified: ${message}.`)];
  if (!plan) return [element("p", {}, message || "waiting to be planned …"), bar(fraction, "planning")];
  const { duration, certificate } = plan;
  const clearance = certificate.clearance.place === "far" ? "nothing near" : `clearance ${number(1000 * certificate.clearance.value, 0, "mm")}`;
  return [
    element("p", { class: "good" }, `Version ${title(version)} is certified: ${number(duration, 2, "s")}, ${clearance}.`),
    element("button", { type: "button", id: "edit-run", "data-key": "run" }, "Go to Run"),
  ];
}
