// Two plots: the log-likelihood while each way's model was trained (the paper's Fig. 4), and that of every demonstration.
import { element, hideSection, hint } from "../elements.js";
import { LinePlot } from "../line_plot.js";
import { demonstrationNumbers } from "../store.js";
import { formatNumber } from "../texts.js";
import { wayVariable } from "../way_colors.js";

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function likelihoodPlots(place, { store, readOnly }) {
  const body = readOnly ? place : element("div", {}); // who works looks at them now and then, who reviews reads all
  if (body !== place) place.append(element("details", {}, element("summary", {}, "Log-likelihoods"), body));
  let shown = "";
  /** @type {LinePlot[]} */
  let plots = [];
  /** @param {State} state */
  const draw = (state) => {
    const run = state.selectedRun;
    hideSection(place, !run?.learned.clusters.length);
    if (!run?.learned.clusters.length || place.closest("[role=tabpanel][hidden]")) return;
    const numbers = demonstrationNumbers(state);
    const key = `${run.id} ${numbers.size}`;
    if (key === shown) return;
    shown = key;
    for (const plot of plots) plot.remove();
    body.replaceChildren();
    plots = drawPlots(body, run.learned.clusters, numbers);
  };
  return { show: () => draw(store.state), update: (state) => draw(state) };
}

/** @param {HTMLElement} place @param {Cluster[]} clusters @param {Map<string, number>} numbers */
function drawPlots(place, clusters, numbers) {
  const trained = clusters.filter((cluster) => cluster.convergence.length > 0);
  if (trained.length) return [plotConvergence(place, trained), plotLikelihoods(place, trained, numbers)];
  place.append(hint("No model was trained: the ways have too few demonstrations."));
  return [];
}

/** @param {HTMLElement} place @param {Cluster[]} clusters */
function plotConvergence(place, clusters) {
  const ends = clusters.map(({ index, convergence }) => {
    const [first, last] = [convergence[0], convergence[convergence.length - 1]];
    return `way ${index}: ${formatNumber(first, 0)} to ${formatNumber(last, 0)} in ${convergence.length} iterations`;
  });
  const plot = new LinePlot(place, {
    title: "Log-likelihood by training iteration, in the colours of the ways: level at the end means learned",
    label: `Log-likelihood while training. ${ends.join("; ")}`,
    series: clusters.map((cluster) => style(cluster)),
  });
  const longest = Math.max(...clusters.map(({ convergence }) => convergence.length));
  const iterations = Array.from({ length: longest }, (_, i) => i);
  plot.setData([
    iterations.map((i) => i + 1),
    ...clusters.map(({ convergence }) => iterations.map((i) => convergence[i] ?? null)),
  ]);
  return plot;
}

/** @param {HTMLElement} place @param {Cluster[]} clusters @param {Map<string, number>} numbers */
function plotLikelihoods(place, clusters, numbers) {
  const scores = clusters.flatMap(({ index, scores }) =>
    scores.map((score) => ({ ...score, way: index, number: numbers.get(score.demonstration) ?? 0 })),
  );
  scores.sort((a, b) => a.number - b.number);
  const least = scores.reduce((a, b) => (b.log_likelihood < a.log_likelihood ? b : a));
  const plot = new LinePlot(place, {
    title: "Log-likelihood by demonstration: one far below its way's others departs from them",
    label: `Log-likelihood of every demonstration; the least is ${formatNumber(least.log_likelihood, 0)}, of demonstration ${least.number}`,
    series: clusters.map((cluster) => ({ ...style(cluster), points: true })),
  });
  plot.setData([
    scores.map(({ number }) => number),
    ...clusters.map(({ index }) => scores.map((score) => (score.way === index ? score.log_likelihood : null))),
  ]);
  return plot;
}

/** @param {Cluster} cluster */
const style = ({ index }) => ({ label: `way ${index}`, color: wayVariable(index) });
