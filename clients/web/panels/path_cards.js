// The choice: one card a way, with what speaks for it and against it; and which run is looked at.
import { at, post } from "../api.js";
import { command, element, facts, hint, next, number, plural, replace, sentence } from "../elements.js";
import { pathOf, pathsOf, runOf } from "../store.js";
import { Prospects } from "./path_summaries.js";

const WAYS = 6; // colours --way-0 to --way-5

export function cards(place, { store, attempt, open }) {
  const prospects = new Prospects(store);
  place.addEventListener("click", (event) => {
    const { learn, plan, edit, run, path } = event.target.closest("[data-learn], [data-plan], [data-edit], [data-run], [data-path]")?.dataset ?? {};
    if (learn) attempt(() => post(at("tasks", store.state.task, "jobs"), { kind: "learn" }));
    if (plan) attempt(() => post(at("paths", plan, "plans")));
    if (path || plan || edit || run) store.set({ path: path ?? plan ?? edit ?? run });
    if (edit) open("edit");
    if (run) open("run");
  });
  place.addEventListener("change", (event) => {
    if (event.target.matches("select")) store.set({ run: event.target.value });
  });
  pointAt(place, store);
  const seen = () => !place.closest("[role=tabpanel]").hidden;
  return {
    show: () => prospects.look(store.state),
    update(state, changed) {
      if (seen() && ["runs", "run", "newest", "jobs"].some((name) => changed.has(name))) prospects.look(state);
      if (["runs", "run", "newest", "path", "jobs", "task", "demonstrations", "prospects"].some((name) => changed.has(name))) replace(place, content(state));
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

// Whatever carries data-focus puts the focus on its way while the pointer or the keyboard is on it.
export function pointAt(place, store) {
  const focus = (event) => {
    const [kind, id] = event.target.closest("[data-focus]")?.dataset.focus.split(" ") ?? [];
    store.set({ focus: kind ? { kind, id } : null });
  };
  place.addEventListener("pointerover", focus);
  place.addEventListener("focusin", focus);
  place.addEventListener("pointerleave", () => store.set({ focus: null }));
}

export function markFocus(place, focus) {
  for (const marked of place.querySelectorAll("[data-focus]")) {
    marked.classList.toggle("here", Boolean(focus) && marked.dataset.focus === `${focus.kind} ${focus.id}`);
  }
}

export const wayClass = (cluster) => `way-${(cluster - 1) % WAYS}`;

function content(state) {
  const run = runOf(state);
  const usable = (state.demonstrations ?? []).filter((d) => d.verdict !== "reject" && d.mark !== "bad" && !d.discarded_ns);
  const busy = (state.jobs ?? []).some((job) => ["running", "queued"].includes(job.state) && job.kind !== "plan");
  const learn = (words) => element("p", {}, element("button", { type: "button", class: "primary", "data-learn": "1", "data-key": "learn", disabled: busy && "" }, words));
  if (!run?.learned.clusters.length) {
    if (state.runs === null && state.task) return hint("The runs cannot be read yet: the service does not answer.");
    return usable.length
      ? [hint(`${usable.length} ${plural(usable.length, "demonstration")} can be learned from. Learning finds the different ways, keeps the demonstrations that agree, and fits a smooth path to each way.`), learn("Learn the ways")]
      : [hint("Nothing to learn from yet. Show the task a few times first, each way at least three times; then learn it here, or with:"), command(`teachpath learn ${state.task || "TASK"}`), next("demonstrate", "Show the task")];
  }
  const fresh = usable.filter((d) => !run.learned.demonstrations.includes(d.id)).length;
  return [
    state.runs.length > 1 && chooser(state.runs, run),
    hint("One card for each way that was shown. Choose one and certify it: that proves that the arm can follow, and lets you run it."),
    ...run.learned.notes.map((note) => element("p", { class: "note" }, sentence(note))),
    run.learned.clusters.map((cluster) => card(state, cluster)),
    run === state.runs[0] && fresh > 0 && hint(`${fresh} ${plural(fresh, "demonstration")} came after this run.`),
    learn(fresh > 0 ? "Learn again" : "Learn anew"),
  ];
}

function chooser(runs, run) {
  const options = runs.map((other, i) => {
    const ways = other.learned.clusters.length;
    const at = new Date(other.created_ns / 1e6).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
    return element("option", { value: other.id, selected: other === run && "" }, `${at}, ${ways} ${plural(ways, "way")}${i ? "" : " (newest)"}`);
  });
  return element("label", { class: "chooser" }, "Run ", element("select", { "data-key": "runs" }, options));
}

function card(state, cluster) {
  const path = pathsOf(state).find((other) => other.cluster === cluster.index);
  const kept = cluster.scores.filter((score) => score.selected).length;
  const name = element("h3", {}, element("span", { class: `swatch ${wayClass(cluster.index)}` }), `Way ${cluster.index}`);
  const head = [name, element("span", { class: "members" }, `${cluster.members.length} ${plural(cluster.members.length, "demonstration")}`)];
  if (!path) return element("article", { class: "card" }, element("header", {}, head), element("p", { class: "note" }, cluster.note || "No path was learned."));
  const chosen = pathOf(state).id === path.id;
  const spread = cluster.spread ?? [];
  const outlook = state.prospects[path.id] ?? {};
  return element(
    "article",
    { class: `card ${chosen ? "chosen" : ""}`, "data-focus": `paths ${path.id}` },
    element("header", {}, head, element("button", { type: "button", class: "pick", "aria-pressed": String(chosen), "data-path": path.id, "data-key": `pick ${path.id}`, "aria-label": `${chosen ? "chosen" : "choose"}: way ${cluster.index}` }, chosen ? "chosen" : "choose")),
    facts([
      ["Agree", `${kept} of ${cluster.members.length}${path.fit?.tube > 0 ? `, within ${number(path.fit.tube * 1000, 0, "mm")}` : ""}`],
      ["Spread", spread.length > 0 && `${number(median(spread) * 1000, 0, "mm")}, at most ${number(Math.max(...spread) * 1000, 0, "mm")}`],
      path.version > 1 && ["Edited", `version ${path.version}`],
      ["Path", `${path.curve.control_points.length} points${path.fit ? `, at most ${number(path.fit.largest * 1000, 1, "mm")} off` : ""}`],
      ...outlook.facts ?? [],
    ]),
    outlook.fault && element("p", { class: "failed" }, sentence(outlook.fault)),
    cluster.ambiguous && element("p", { class: "note" }, sentence(cluster.ambiguous)),
    cluster.note && element("p", { class: "note" }, sentence(cluster.note)),
    path.note && element("p", { class: "note" }, sentence(path.note)),
    element(
      "p",
      { class: "orders" },
      !outlook.planned && element("button", { type: "button", "data-plan": path.id, "data-key": `plan ${path.id}`, disabled: outlook.planning && "", "aria-label": `Certify way ${cluster.index}` }, outlook.planning ? "Planning …" : "Certify"),
      element("button", { type: "button", "data-edit": path.id, "data-key": `edit ${path.id}`, "aria-label": `Edit way ${cluster.index}` }, "Edit"),
      outlook.planned && element("button", { type: "button", "data-run": path.id, "data-key": `run ${path.id}`, "aria-label": `Run way ${cluster.index}` }, "Run"),
    ),
  );
}

function median(values) {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
}
