// The card of one way: what is known of its path, and what can be done with it.
import { definitionList, element } from "../elements.js";
import { latestPaths, selectedPath } from "../store.js";
import { capitalize, formatLength, pluralize } from "../texts.js";
import { wayClass } from "../way_colors.js";

/** @param {State} state @param {Cluster} cluster @param {boolean} readOnly */
export function pathCard(state, cluster, readOnly) {
  const path = latestPaths(state).find((other) => other.cluster === cluster.index);
  if (!path) {
    const why = element("p", { class: "note" }, cluster.note || "No path was learned.");
    return element("article", { class: "card" }, element("header", {}, heading(cluster)), why);
  }
  const chosen = selectedPath(state)?.id === path.id;
  const summary = state.pathSummaries[path.id] ?? { planning: false, planned: false };
  const notes = [cluster.ambiguous, cluster.note, path.note].filter(Boolean);
  return element(
    "article",
    { class: `card ${chosen ? "chosen" : ""}`, "data-focus": `paths ${path.id}` },
    element("header", {}, heading(cluster), pickButton(path, chosen)),
    definitionList([...facts(path, cluster), ...(summary.facts ?? [])]),
    summary.error && element("p", { class: "failed" }, capitalize(summary.error)),
    notes.map((note) => element("p", { class: "note" }, capitalize(note))),
    actions(path, summary, readOnly),
  );
}

/** @param {Cluster} cluster @returns {Child[]} */
function heading({ index, members }) {
  return [
    element("h3", {}, element("span", { class: `swatch ${wayClass(index)}` }), `Way ${index}`),
    element("span", { class: "members" }, `${members.length} ${pluralize(members.length, "demonstration")}`),
  ];
}

/** @param {LearnedPath} path @param {boolean} chosen */
function pickButton({ id, cluster }, chosen) {
  const text = chosen ? "chosen" : "choose";
  const label = { "aria-pressed": String(chosen), "aria-label": `${text}: way ${cluster}` };
  const data = { "data-path": id, "data-key": `pick ${id}` };
  return element("button", { type: "button", class: "pick", ...label, ...data }, text);
}

/** @param {LearnedPath} path @param {Cluster} cluster @returns {Fact[]} */
function facts({ version, curve, fit }, { scores, members, spread }) {
  const kept = scores.filter((score) => score.selected).length;
  const within = fit && fit.tube > 0 ? `, within ${formatLength(fit.tube)}` : "";
  const off = fit ? `, at most ${formatLength(fit.largest)} off` : "";
  return [
    ["Agree", `${kept} of ${members.length}${within}`],
    ["Spread", spread?.length ? `${formatLength(median(spread))}, at most ${formatLength(Math.max(...spread))}` : ""],
    ["Edited", version > 1 && `version ${version}`],
    ["Path", `${curve.control_points.length} points${off}`],
  ];
}

/** @param {LearnedPath} path @param {PathSummary} summary @param {boolean} readOnly */
function actions({ id, cluster }, { planning, planned }, readOnly) {
  /** @param {string} verb @param {string} text @param {string} label @param {boolean} disabled */
  const button = (verb, text, label, disabled = false) => {
    const data = { [`data-${verb}`]: id, "data-key": `${verb} ${id}` };
    const attributes = { type: "button", "aria-label": `${label} way ${cluster}`, disabled: disabled && "" };
    return element("button", { ...attributes, ...data }, text);
  };
  if (readOnly) return planned && element("p", { class: "buttons" }, button("run", "Motion", "See the motion of"));
  return element(
    "p",
    { class: "buttons" },
    !planned && button("plan", planning ? "Planning …" : "Certify", "Certify", planning),
    button("edit", "Edit", "Edit"),
    planned && button("run", "Run", "Run"),
  );
}

/** @param {number[]} values */
function median(values) {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
}
