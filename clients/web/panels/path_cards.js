// One card per way, with what is known of its path; and which run is shown.
import { post, resourcePath } from "../api.js";
import {
  capitalize,
  codeBlock,
  definitionList,
  element,
  formatNumber,
  hint,
  patchChildren,
  pluralize,
  tabButton,
} from "../elements.js";
import { latestPaths, selectedPath, selectedRun } from "../store.js";
import { wayClass } from "../way_colors.js";
import { markFocus, trackFocus } from "./focus.js";
import { PathSummaries } from "./path_summaries.js";

export function pathCards(place, { store, attempt, open }) {
  const pathSummaries = new PathSummaries(store);
  place.addEventListener("click", (event) => {
    const { learn, plan, edit, run, path } =
      event.target.closest("[data-learn], [data-plan], [data-edit], [data-run], [data-path]")?.dataset ?? {};
    if (learn) attempt(() => post(resourcePath("tasks", store.state.task, "jobs"), { kind: "learn" }));
    if (plan) attempt(() => post(resourcePath("paths", plan, "plans")));
    if (path || plan || edit || run) store.set({ path: path ?? plan ?? edit ?? run });
    if (edit) open("edit");
    if (run) open("run");
  });
  place.addEventListener("change", (event) => {
    if (event.target.matches("select")) store.set({ run: event.target.value });
  });
  trackFocus(place, store);
  const seen = () => !place.closest("[role=tabpanel]").hidden;
  return {
    show: () => pathSummaries.refresh(store.state),
    update(state, changed) {
      if (seen() && ["runs", "run", "latestVersions", "jobs"].some((name) => changed.has(name)))
        pathSummaries.refresh(state);
      if (
        ["runs", "run", "latestVersions", "path", "jobs", "task", "demonstrations", "pathSummaries"].some((name) =>
          changed.has(name),
        )
      )
        patchChildren(place, content(state));
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

function content(state) {
  const run = selectedRun(state);
  const usable = (state.demonstrations ?? []).filter(
    (d) => d.verdict !== "reject" && d.mark !== "bad" && !d.discarded_ns,
  );
  const busy = (state.jobs ?? []).some((job) => ["running", "queued"].includes(job.state) && job.kind !== "plan");
  const learn = (words) =>
    element(
      "p",
      {},
      element(
        "button",
        { type: "button", class: "primary", "data-learn": "1", "data-key": "learn", disabled: busy && "" },
        words,
      ),
    );
  if (!run?.learned.clusters.length) {
    if (state.runs === null && state.task) return hint("The runs cannot be read yet: the service does not answer.");
    return usable.length
      ? [
          hint(
            `${usable.length} ${pluralize(usable.length, "demonstration")} can be learned from. Learning finds the different ways, keeps the demonstrations that agree, and fits a smooth path to each way.`,
          ),
          learn("Learn the ways"),
        ]
      : [
          hint(
            "Nothing to learn from yet. Show the task a few times first, each way at least three times; then learn it here, or with:",
          ),
          codeBlock(`teachpath learn ${state.task || "TASK"}`),
          tabButton("demonstrate", "Show the task"),
        ];
  }
  const fresh = usable.filter((d) => !run.learned.demonstrations.includes(d.id)).length;
  return [
    state.runs.length > 1 && runSelect(state.runs, run),
    hint(
      "One card for each way that was shown. Choose one and certify it: that proves that the arm can follow, and lets you run it.",
    ),
    ...run.learned.notes.map((note) => element("p", { class: "note" }, capitalize(note))),
    run.learned.clusters.map((cluster) => card(state, cluster)),
    run === state.runs[0] && fresh > 0 && hint(`${fresh} ${pluralize(fresh, "demonstration")} came after this run.`),
    learn(fresh > 0 ? "Learn again" : "Learn anew"),
  ];
}

function runSelect(runs, run) {
  const options = runs.map((other, i) => {
    const ways = other.learned.clusters.length;
    const time = new Date(other.created_ns / 1e6).toLocaleTimeString([], { hour: "2-digit", minute: "2-digit" });
    return element(
      "option",
      { value: other.id, selected: other === run && "" },
      `${time}, ${ways} ${pluralize(ways, "way")}${i ? "" : " (newest)"}`,
    );
  });
  return element("label", { class: "chooser" }, "Run ", element("select", { "data-key": "runs" }, options));
}

function card(state, cluster) {
  const path = latestPaths(state).find((other) => other.cluster === cluster.index);
  const kept = cluster.scores.filter((score) => score.selected).length;
  const name = element(
    "h3",
    {},
    element("span", { class: `swatch ${wayClass(cluster.index)}` }),
    `Way ${cluster.index}`,
  );
  const head = [
    name,
    element(
      "span",
      { class: "members" },
      `${cluster.members.length} ${pluralize(cluster.members.length, "demonstration")}`,
    ),
  ];
  if (!path)
    return element(
      "article",
      { class: "card" },
      element("header", {}, head),
      element("p", { class: "note" }, cluster.note || "No path was learned."),
    );
  const chosen = selectedPath(state).id === path.id;
  const spread = cluster.spread ?? [];
  const summary = state.pathSummaries[path.id] ?? {};
  return element(
    "article",
    { class: `card ${chosen ? "chosen" : ""}`, "data-focus": `paths ${path.id}` },
    element(
      "header",
      {},
      head,
      element(
        "button",
        {
          type: "button",
          class: "pick",
          "aria-pressed": String(chosen),
          "data-path": path.id,
          "data-key": `pick ${path.id}`,
          "aria-label": `${chosen ? "chosen" : "choose"}: way ${cluster.index}`,
        },
        chosen ? "chosen" : "choose",
      ),
    ),
    definitionList([
      [
        "Agree",
        `${kept} of ${cluster.members.length}${path.fit?.tube > 0 ? `, within ${formatNumber(path.fit.tube * 1000, 0, "mm")}` : ""}`,
      ],
      [
        "Spread",
        spread.length > 0 &&
          `${formatNumber(median(spread) * 1000, 0, "mm")}, at most ${formatNumber(Math.max(...spread) * 1000, 0, "mm")}`,
      ],
      path.version > 1 && ["Edited", `version ${path.version}`],
      [
        "Path",
        `${path.curve.control_points.length} points${path.fit ? `, at most ${formatNumber(path.fit.largest * 1000, 1, "mm")} off` : ""}`,
      ],
      ...(summary.facts ?? []),
    ]),
    summary.error && element("p", { class: "failed" }, capitalize(summary.error)),
    cluster.ambiguous && element("p", { class: "note" }, capitalize(cluster.ambiguous)),
    cluster.note && element("p", { class: "note" }, capitalize(cluster.note)),
    path.note && element("p", { class: "note" }, capitalize(path.note)),
    element(
      "p",
      { class: "buttons" },
      !summary.planned &&
        element(
          "button",
          {
            type: "button",
            "data-plan": path.id,
            "data-key": `plan ${path.id}`,
            disabled: summary.planning && "",
            "aria-label": `Certify way ${cluster.index}`,
          },
          summary.planning ? "Planning …" : "Certify",
        ),
      element(
        "button",
        {
          type: "button",
          "data-edit": path.id,
          "data-key": `edit ${path.id}`,
          "aria-label": `Edit way ${cluster.index}`,
        },
        "Edit",
      ),
      summary.planned &&
        element(
          "button",
          {
            type: "button",
            "data-run": path.id,
            "data-key": `run ${path.id}`,
            "aria-label": `Run way ${cluster.index}`,
          },
          "Run",
        ),
    ),
  );
}

function median(values) {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
}
