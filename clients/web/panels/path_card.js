// The card of one way: whether the arm can follow its path, what can be done with it, and folded what else is known.
import { blocked, definitionList, element } from "../elements.js";
import { icon } from "../icons.js";
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
    verdict(summary),
    notes.map((note) => element("p", { class: "note" }, capitalize(note))),
    actions(path, summary, readOnly, chosen),
    element(
      "details",
      {},
      element("summary", {}, "Figures"),
      definitionList([...facts(path, cluster), ...(summary.facts ?? [])]),
    ),
  );
}

/** @param {Cluster} cluster @returns {Child[]} */
function heading({ index, members }) {
  return [
    element("h3", {}, element("span", { class: `swatch ${wayClass(index)}` }), `Way ${index}`),
    element("span", { class: "members" }, `${members.length} ${pluralize(members.length, "demonstration")}`),
  ];
}

/** The one sentence that counts. @param {PathSummary} summary */
function verdict({ verdict: text, error, planned }) {
  if (error) return element("p", { class: "failed" }, capitalize(error));
  if (!text) return element("p", { class: "hint" }, "Whether the arm can follow is being assessed …");
  return element("p", { class: planned ? "good" : "" }, planned && icon("certify"), text);
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

/**
 * What can be done with it; the next step of the chosen way stands out.
 * @param {LearnedPath} path
 * @param {PathSummary} summary
 * @param {boolean} readOnly
 * @param {boolean} chosen
 */
function actions({ id, cluster }, { planning, planned, error }, readOnly, chosen) {
  const next = planned ? "run" : error ? "edit" : "plan";
  /** @param {string} verb @param {string} drawing @param {string} text @param {string} label */
  const button = (verb, drawing, text, label) => {
    const data = { [`data-${verb}`]: id, "data-key": `${verb} ${id}` };
    const look = {
      type: "button",
      class: chosen && verb === next && "primary",
      "aria-label": `${label} way ${cluster}`,
    };
    const why = verb === "plan" && planning ? "Its motion is being planned." : "";
    return element("button", { ...look, ...data, ...blocked(why) }, icon(drawing), text);
  };
  if (readOnly)
    return planned && element("p", { class: "buttons" }, button("run", "start", "Motion", "See the motion of"));
  return element(
    "p",
    { class: "buttons" },
    !planned && button("plan", "certify", planning ? "Planning …" : "Certify", "Certify"),
    planned && button("run", "start", "Run", "Run"),
    button("edit", "edit", "Edit", "Edit"),
  );
}

/** @param {number[]} values */
function median(values) {
  return [...values].sort((a, b) => a - b)[Math.floor(values.length / 2)];
}
