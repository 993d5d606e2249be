// Table I: who was selected in each way, how they rank, by what margin, and in words why one was left out.
import { capitalize, element, formatNumber, patchChildren } from "../elements.js";
import { selectedRun } from "../store.js";
import { wayClass } from "../way_colors.js";
import { markFocus, trackFocus } from "./focus.js";

// The columns between a demonstration and whether it is kept: [name, what it says, of a score]; what is not known is left empty.
const COLUMNS = {
  rank: ["Rank", "1 is the most consistent", (score) => String(score.rank)],
  z: ["z", "how far it is from the others of its way: 0 is like them or better", (score) => figure(score.z, 1)],
  margin: ["Margin", "by how much it is better than the next in rank", (score) => figure(score.margin, 1)],
  likelihood: [
    "Log-lik.",
    "log-likelihood under the model that judges it",
    (score) => (score.z === null ? "" : figure(score.log_likelihood, 0)),
  ],
};
// In the mode of the paper ranks go by the log-likelihood, else by z.
const COLUMNS_BY_MODE = { default: ["rank", "z", "margin", "likelihood"], other: ["rank", "likelihood", "margin"] };
const NOTES_BY_MODE = {
  default:
    "Ranked by z: how far one is from the others of its way in course, shape, smoothness and bending, in robust standard deviations; 0 is like them or better.",
  other: "Ranked by the log-likelihood under the model of the way.",
};
const figure = (value, digits) => (value === null ? "" : formatNumber(value, digits));

export function selectionTable(place, { store }) {
  trackFocus(place, store);
  return {
    update(state, changed) {
      if (["runs", "run", "demonstrations"].some((name) => changed.has(name))) {
        const run = selectedRun(state)?.learned;
        place.parentElement.hidden = !run?.clusters.length;
        const numbers = new Map((state.demonstrations ?? []).map((d) => [d.id, d.number]));
        if (run?.clusters.length) patchChildren(place, table(run, numbers));
      }
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

function table(run, numbers) {
  const mode = run.mode === "default" ? "default" : "other";
  const columns = COLUMNS_BY_MODE[mode].map((name) => COLUMNS[name]);
  const heads = [
    ["Way", ""],
    ["Shown", "number of the demonstration"],
    ...columns,
    ["Kept", "the path of its way is fitted to it"],
  ];
  const head = element(
    "thead",
    {},
    element(
      "tr",
      {},
      heads.map(([name, title]) => element("th", { scope: "col", title }, name)),
    ),
  );
  return [
    element(
      "table",
      { class: "selection" },
      head,
      run.clusters.map((cluster) => rows(cluster, numbers, columns)),
    ),
    element(
      "p",
      { class: "note" },
      `${NOTES_BY_MODE[mode]} The margin is the lead over the next in rank. A way's path is fitted to what is kept (✓).`,
    ),
  ];
}

function rows(cluster, numbers, columns) {
  const why = (score) => score.note || score.deviation?.sentence;
  const height = cluster.scores.length + cluster.scores.filter(why).length;
  const way = element(
    "th",
    { scope: "rowgroup", rowspan: String(height) },
    element("span", { class: `swatch ${wayClass(cluster.index)}` }),
    String(cluster.index),
  );
  const reason = (score) =>
    element(
      "tr",
      { class: "why", "data-focus": `demonstrations ${score.demonstration}` },
      element("td", { colspan: String(columns.length + 2) }, capitalize(why(score))),
    );
  return element(
    "tbody",
    {},
    cluster.scores.map((score, i) => [row(score, numbers, i === 0 && way, columns), why(score) && reason(score)]),
  );
}

function row(score, numbers, way, columns) {
  const tick = element("span", { class: "tick", role: "img", "aria-label": "kept" }, "✓");
  const left = element("span", { class: "cross", role: "img", "aria-label": "left out" }, "–");
  const figures = [
    String(numbers.get(score.demonstration) ?? score.demonstration),
    ...columns.map(([, , of]) => of(score)),
  ];
  return element(
    "tr",
    { class: score.selected ? "selected" : "", "data-focus": `demonstrations ${score.demonstration}` },
    way,
    figures.map((text) => element("td", { class: "figure" }, text)),
    element("td", {}, score.selected ? tick : left),
  );
}
