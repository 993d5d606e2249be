// Two plots: how the likelihood grew while each way's model was trained (the paper's Fig. 4), and how the demonstrations score.
import { element, hint, number, replace } from "../elements.js";
import { runOf } from "../store.js";
import { wayColor } from "../meshes.js";
import { plot } from "../line_plot.js";

export function scores(place, { store }) {
  let shown = "";
  const [growth, ranks] = [element("div", { class: "plot" }), element("div", { class: "plot" })];
  place.append(growth, ranks);
  const draw = (state) => {
    const run = runOf(state);
    place.parentElement.hidden = !run?.learned.clusters.length;
    if (!run || place.parentElement.hidden || place.closest("[role=tabpanel]").hidden) return;
    const numbers = new Map((state.demonstrations ?? []).map((d) => [d.id, d.number]));
    const looks = `${run.id} ${numbers.size}`;
    if (looks === shown) return;
    shown = looks;
    convergence(growth, run.learned.clusters);
    likelihoods(ranks, run.learned.clusters, numbers);
  };
  return { show: () => draw(store.state), update: (state) => draw(state) };
}

function convergence(place, clusters) {
  const trained = clusters.filter((cluster) => cluster.convergence.length > 1);
  if (!trained.length) return replace(place, hint("No model was trained: the ways have too few demonstrations."));
  const longest = Math.max(...trained.map((cluster) => cluster.convergence.length));
  const data = [Array.from({ length: longest }, (_, i) => i + 1), ...trained.map((c) => Array.from({ length: longest }, (_, i) => c.convergence[i] ?? null))];
  const ends = trained.map((c) => `way ${c.index}: ${number(c.convergence[0], 0)} to ${number(c.convergence.at(-1), 0)} in ${c.convergence.length} iterations`);
  return plot(place, {
    label: `Log-likelihood while training. ${ends.join("; ")}`,
    title: "Log-likelihood by training iteration, in the colours of the ways: level at the end means learned",
    data,
    series: trained.map((c) => ({ label: `way ${c.index}`, color: wayColor(c.index) })),
  });
}

function likelihoods(place, clusters, numbers) {
  const trained = clusters.filter((cluster) => cluster.convergence.length > 0);
  if (!trained.length) return replace(place);
  const all = trained.flatMap((cluster) => cluster.scores.map((score) => ({ ...score, way: cluster.index, number: numbers.get(score.demonstration) ?? 0 })));
  all.sort((a, b) => a.number - b.number);
  const data = [all.map((score) => score.number), ...trained.map((c) => all.map((score) => (score.way === c.index ? score.log_likelihood : null)))];
  const least = all.reduce((a, b) => (b.log_likelihood < a.log_likelihood ? b : a));
  return plot(place, {
    label: `Log-likelihood of every demonstration; the least is ${number(least.log_likelihood, 0)}, of demonstration ${least.number}`,
    title: "Log-likelihood by demonstration: one far below its way's others departs from them",
    data,
    series: trained.map((c) => ({ label: `way ${c.index}`, color: wayColor(c.index), points: true })),
  });
}
