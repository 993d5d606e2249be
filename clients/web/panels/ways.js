// Ways: what was learned, as a choice between the ways in which the task was done.
import { at, post } from "../api.js";
import { bar, command, element, hint, number, replace, section, sentence } from "../elements.js";
import { runOf } from "../store.js";

const WAYS = 6; // colours --way-0 to --way-5

let work, learned;

export const panel = {
  id: "ways",
  title: "Ways",

  mount(place, { store, attempt }) {
    work = section(place, "work", "At work");
    learned = section(place, "learned", "Learned ways");
    place.addEventListener("click", (event) => {
      const { cancel, learn } = event.target.closest("button")?.dataset ?? {};
      if (cancel) attempt(() => post(at("jobs", cancel, "cancel")));
      if (learn) attempt(() => post(at("tasks", store.state.task, "jobs"), { kind: "learn" }));
    });
  },

  update(state, changed) {
    if (changed.has("jobs")) replace(work, jobs(state.jobs ?? []));
    work.parentElement.hidden = !work.childElementCount;
    if (["runs", "run", "task", "demonstrations"].some((name) => changed.has(name))) replace(learned, content(state));
  },
};

// Jobs that run; the last one when it failed.
function jobs(all) {
  const running = all.filter((job) => job.state === "running" || job.state === "queued");
  const failed = all.at(-1)?.state === "failed" ? [all.at(-1)] : [];
  return [
    ...running.map((job) =>
      element(
        "div",
        { class: "job" },
        element("p", {}, `${sentence(job.kind)}: ${job.message || job.state} `, element("button", { type: "button", "data-cancel": job.id, "data-key": job.id }, "Cancel")),
        bar(job.fraction, `${job.kind} job`),
      ),
    ),
    ...failed.map((job) => element("p", { class: "job failed" }, `${sentence(job.kind)} failed: ${job.message}`)),
  ];
}

function content(state) {
  const run = runOf(state)?.learned;
  if (!run?.clusters.length) {
    return [
      hint(state.runs === null && state.task ? "The runs cannot be read yet." : "Nothing learned yet. When the task has been shown a few times, learn its ways:"),
      state.demonstrations?.length ? element("button", { type: "button", "data-learn": "1", "data-key": "learn" }, "Learn the ways") : command(`teachpath learn ${state.task || "TASK"}`),
    ];
  }
  const numbers = new Map((state.demonstrations ?? []).map((d) => [d.id, d.number]));
  const head = element("thead", {}, element("tr", {}, ["Way", "Demonstration", "Log-likelihood", "Selected"].map((t) => element("th", { scope: "col" }, t))));
  const notes = [...run.notes, ...run.clusters.map((c) => c.note && `Way ${c.index}: ${c.note}`)].filter(Boolean);
  return [element("table", {}, head, run.clusters.map((cluster) => rows(cluster, numbers))), ...notes.map((text) => element("p", { class: "note" }, text))];
}

function rows(cluster, numbers) {
  const way = element("th", { scope: "rowgroup", rowspan: String(cluster.scores.length) }, element("span", { class: `swatch way-${(cluster.index - 1) % WAYS}` }), String(cluster.index));
  return element(
    "tbody",
    {},
    cluster.scores.map((score, i) =>
      element(
        "tr",
        { class: score.selected ? "selected" : "" },
        i === 0 && way,
        element("td", { class: "figure" }, String(numbers.get(score.demonstration) ?? score.demonstration)),
        element("td", { class: "figure" }, number(score.log_likelihood, 1)),
        element("td", {}, score.selected && element("span", { class: "tick", role: "img", "aria-label": "selected", title: "The path of this way is fitted to it." }, "✓")),
      ),
    ),
  );
}
