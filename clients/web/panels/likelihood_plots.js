// Two plots: the log-likelihood while each way's model was trained (the paper's Fig. 4), and that of every demonstration.
import { formatNumber, hint } from "../elements.js";
import { LinePlot } from "../line_plot.js";
import { selectedRun } from "../store.js";
import { wayVariable } from "../way_colors.js";

export function likelihoodPlots(place, { store }) {
  let shown = "";
  let plots = [];
  const draw = (state) => {
    const run = selectedRun(state);
    place.parentElement.hidden = !run?.learned.clusters.length;
    if (!run || place.parentElement.hidden || place.closest("[role=tabpanel]").hidden) return;
    const numbers = new Map((state.demonstrations ?? []).map((d) => [d.id, d.number]));
    const key = `${run.id} ${numbers.size}`;
    if (key === shown) return;
    shown = key;
    for (const plot of plots) plot.remove();
    place.replaceChildren();
    plots = drawPlots(place, run.learned.clusters, numbers);
  };
  return { show: () => draw(store.state), update: (state) => draw(state) };
}

function drawPlots(place, clusters, numbers) {
  const trained = clusters.filter((cluster) => cluster.convergence.length > 0);
  if (trained.length) return [plotConvergence(place, trained), plotLikelihoods(place, trained, numbers)];
  place.append(hint("No model was trained: the ways have too few demonstrations."));
  return [];
}

function plotConvergence(place, clusters) {
  const ends = clusters.map(
    ({ index, convergence }) =>
      `way ${index}: ${formatNumber(convergence[0], 0)} to ${formatNumber(convergence.at(-1), 0)} in ${convergence.length} iterations`,
  );
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

const style = ({ index }) => ({ label: `way ${index}`, color: wayVariable(index) });
