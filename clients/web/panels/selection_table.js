// Table I: who was selected in each way, how they rank, by what margin, and in words why one was left out.
import { element, hideSection } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { changesAny, demonstrationNumbers } from "../store.js";
import { capitalize, formatNumber } from "../texts.js";
import { wayClass } from "../way_colors.js";
import { markFocus, trackFocus } from "./focus.js";

/** @typedef {{name: string, title: string, of: (score: Score, scores: Score[]) => string}} Column between a demonstration and what is kept */

/** @type {Record<string, Column>} */
const COLUMNS = {
  rank: { name: "Rank", title: "1 is the most consistent", of: (score) => String(score.rank) },
  z: {
    name: "z",
    title: "how far it is from the others of its way: 0 is like them or better",
    of: ({ z }) => figure(z, 1),
  },
  margin: {
    name: "Margin",
    title: "by how much it is better than the next in rank",
    of: ({ margin }) => figure(margin, 1),
  },
  likelihood: {
    name: "Log-lik.",
    title: "log-likelihood under the model of the others or of its way, and its rank by it",
    of: ({ z, log_likelihood }, scores) => {
      if (z === null) return "";
      const better = scores.filter((other) => other.z !== null && other.log_likelihood > log_likelihood);
      return `${figure(log_likelihood, 0)} (${1 + better.length})`;
    },
  },
};
// In the mode of the paper ranks go by the log-likelihood, else by z.
const COLUMNS_BY_MODE = { default: ["rank", "z", "margin", "likelihood"], other: ["rank", "likelihood", "margin"] };
const NOTES_BY_MODE = {
  default:
    "Ranked by z: how far one is from the others of its way in the worst of eight kinds of faults, in robust standard deviations; 0 is like them or better.",
  other: "Ranked by the log-likelihood under the model of the way.",
};
const NOTE = "The margin is the lead over the next in rank. A way's path is fitted to what is kept (✓).";

/** @param {number | null | undefined} value what is not known is left empty @param {number} digits */
const figure = (value, digits) => (value === null || value === undefined ? "" : formatNumber(value, digits));

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function selectionTable(place, { store }) {
  trackFocus(place, store);
  return {
    update(state, changed) {
      if (changesAny(changed, "runs", "selectedRun", "demonstrations")) {
        const run = state.selectedRun?.learned;
        hideSection(place, !run?.clusters.length);
        if (run?.clusters.length) patchChildren(place, table(run, demonstrationNumbers(state)));
      }
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

/** @param {Run["learned"]} run @param {Map<string, number>} numbers @returns {Child[]} */
function table({ mode, clusters }, numbers) {
  const kind = mode === "default" ? "default" : "other";
  const columns = COLUMNS_BY_MODE[kind].map((name) => COLUMNS[name]);
  const heads = [
    { name: "Way", title: "" },
    { name: "Shown", title: "number of the demonstration" },
    ...columns,
    { name: "Kept", title: "the path of its way is fitted to it" },
  ];
  const cells = heads.map(({ name, title }) => element("th", { scope: "col", title }, name));
  const groups = clusters.map((cluster) => rowGroup(cluster, numbers, columns));
  return [
    element("table", { class: "selection" }, element("thead", {}, element("tr", {}, cells)), groups),
    element("p", { class: "note" }, `${NOTES_BY_MODE[kind]} ${NOTE}`),
  ];
}

/** @param {Cluster} cluster @param {Map<string, number>} numbers @param {Column[]} columns */
function rowGroup({ index, scores }, numbers, columns) {
  const height = scores.length + scores.filter(reasonOf).length;
  const swatch = element("span", { class: `swatch ${wayClass(index)}` });
  const way = element("th", { scope: "rowgroup", rowspan: String(height) }, swatch, String(index));
  return element(
    "tbody",
    {},
    scores.map((score, i) => [
      scoreRow(score, scores, numbers, i === 0 && way, columns),
      reasonOf(score) && reasonRow(score, columns.length + 2),
    ]),
  );
}

/** @param {Score} score */
const reasonOf = ({ note, deviation }) => note || deviation?.sentence;

/** @param {Score} score @param {number} width */
function reasonRow(score, width) {
  const focus = { class: "why", "data-focus": `demonstrations ${score.demonstration}` };
  return element("tr", focus, element("td", { colspan: String(width) }, capitalize(reasonOf(score))));
}

/** @param {Score} score @param {Score[]} scores @param {Map<string, number>} numbers @param {Child} way @param {Column[]} columns */
function scoreRow(score, scores, numbers, way, columns) {
  const { demonstration, selected } = score;
  const tick = element("span", { class: "tick", role: "img", "aria-label": "kept" }, "✓");
  const cross = element("span", { class: "cross", role: "img", "aria-label": "left out" }, "–");
  const figures = [String(numbers.get(demonstration) ?? demonstration), ...columns.map(({ of }) => of(score, scores))];
  return element(
    "tr",
    { class: selected ? "selected" : "", "data-focus": `demonstrations ${demonstration}` },
    way,
    figures.map((text) => element("td", { class: "figure" }, text)),
    element("td", {}, selected ? tick : cross),
  );
}
