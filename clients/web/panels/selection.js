// Table I: who was selected in each way, how they rank, by what margin, and in words why one was left out.
import { element, number, replace, sentence } from "../elements.js";
import { runOf } from "../store.js";
import { markFocus, pointAt, wayClass } from "./cards.js";

const HEADS = [["Way", ""], ["Shown", "demonstration"], ["Rank", "1 is the most consistent"], ["Log-lik.", "log-likelihood under the model that judges it"], ["Margin", "by how much it is better than the next in rank"], ["Kept", "the path of its way is fitted to it"]];

export function selection(place, { store }) {
  pointAt(place, store);
  return {
    update(state, changed) {
      if (["runs", "run", "demonstrations"].some((name) => changed.has(name))) {
        const run = runOf(state)?.learned;
        place.parentElement.hidden = !run?.clusters.length;
        const numbers = new Map((state.demonstrations ?? []).map((d) => [d.id, d.number]));
        if (run?.clusters.length) replace(place, table(run, numbers));
      }
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

function table(run, numbers) {
  const head = element("thead", {}, element("tr", {}, HEADS.map(([name, title]) => element("th", { scope: "col", title }, name))));
  const margins = run.mode === "default" ? "Margins are in robust standard deviations." : "Margins are differences of log-likelihood.";
  return [element("table", { class: "selection" }, head, run.clusters.map((cluster) => rows(cluster, numbers))), element("p", { class: "note" }, margins)];
}

function rows(cluster, numbers) {
  const why = (score) => score.note || score.departure?.sentence;
  const height = cluster.scores.length + cluster.scores.filter(why).length;
  const way = element("th", { scope: "rowgroup", rowspan: String(height) }, element("span", { class: `swatch ${wayClass(cluster.index)}` }), String(cluster.index));
  return element("tbody", {}, cluster.scores.map((score, i) => [row(score, numbers, i === 0 && way), why(score) && reason(score, why(score))]));
}

function row(score, numbers, way) {
  const tick = element("span", { class: "tick", role: "img", "aria-label": "kept" }, "✓");
  const left = element("span", { class: "cross", role: "img", "aria-label": "left out" }, "–");
  return element(
    "tr",
    { class: score.selected ? "selected" : "", "data-focus": `demonstrations ${score.demonstration}` },
    way,
    element("td", { class: "figure" }, String(numbers.get(score.demonstration) ?? score.demonstration)),
    element("td", { class: "figure" }, String(score.rank)),
    element("td", { class: "figure" }, number(score.log_likelihood, 0)),
    element("td", { class: "figure" }, score.margin === null ? "" : number(score.margin, 1)),
    element("td", {}, score.selected ? tick : left),
  );
}

const reason = (score, why) => element("tr", { class: "why", "data-focus": `demonstrations ${score.demonstration}` }, element("td", { colspan: "5" }, sentence(why)));
