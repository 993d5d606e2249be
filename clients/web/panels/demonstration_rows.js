// Rows of demonstrations: number, thumbnail, verdict with its reasons, duration, losses, and buttons.
import { element } from "../elements.js";
import { waysOfDemonstrations } from "../store.js";
import { formatNumber } from "../texts.js";
import { fitProjection, thumbnail } from "../thumbnail.js";
import { wayClass } from "../way_colors.js";
import { verdictExplanation } from "./demonstration_elements.js";

/** @type {Record<string, string>} */
export const MARK_SYMBOLS = { "": "☆", good: "★", bad: "⚑" };

/** @type {Record<string, string>} */
const NEXT_MARK = { "": "good", good: "bad", bad: "" }; // mark that a press gives

/**
 * What draws demonstrations in small, all on one scale; nothing where the trajectory is not here.
 * @param {State} state
 * @param {Demonstration[]} demonstrations
 * @param {import("../trajectory_cache.js").TrajectoryCache} trajectories
 */
export function thumbnailMaker(state, demonstrations, trajectories) {
  const ways = waysOfDemonstrations(state);
  const projection = fitProjection(demonstrations.flatMap(({ id }) => [trajectories.get(id) ?? []]));
  /** @param {string} id */
  return (id) => {
    const [points, way] = [trajectories.get(id), ways.get(id)];
    return points && thumbnail(points, projection, way ? wayClass(way) : "");
  };
}

/**
 * @param {Demonstration} demonstration
 * @param {Child} preview
 * @param {boolean} readOnly
 * @param {Set<string> | null} [chosen] ids of those that are selected; null: nothing is selected here
 * @param {string} [station] that it was made at, where there are several
 */
export function demonstrationRow(demonstration, preview, readOnly, chosen = null, station = "") {
  const { id, number, verdict, mark, trim, duration, discarded_ns, statistics } = demonstration;
  const word = discarded_ns ? "discarded" : verdict;
  return element(
    "li",
    { class: word, value: String(number), "data-focus": `demonstrations ${id}` },
    element("span", { class: "number" }, chosen ? choice(demonstration, chosen) : String(number)),
    element("span", { class: "preview" }, preview),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, statistics.lost > 0 && `${statistics.lost} lost`),
    element("span", { class: "figure" }, formatNumber(duration, 1, "s")),
    !readOnly && rowButtons(demonstration),
    verdictExplanation(demonstration, mark && `marked ${mark}`, trim ? "trimmed" : "", station && `at ${station}`),
  );
}

/** @param {Demonstration} demonstration @param {Set<string>} chosen */
function choice({ id, number }, chosen) {
  const checked = chosen.has(id) ? "" : null;
  const box = { type: "checkbox", "data-chosen": id, "data-key": `choose ${id}`, checked };
  return element(
    "label",
    {},
    element("input", { ...box, "aria-label": `Select demonstration ${number}` }),
    String(number),
  );
}

/** @param {Demonstration} demonstration */
function rowButtons({ id, number, mark, discarded_ns }) {
  const [verb, sign, name] = discarded_ns ? ["restore", "↶", "Restore"] : ["discard", "×", "Discard"];
  const next = NEXT_MARK[mark] ?? "";
  const marking = `Mark demonstration ${number} ${next || "neither good nor bad"}`;
  const markLabel = { "aria-label": marking, title: marking };
  const discardLabel = { "aria-label": `${name} demonstration ${number}`, title: name };
  const button = { type: "button", class: "close" };
  return [
    element(
      "button",
      { ...button, ...markLabel, "data-marked": id, "data-mark": next, "data-key": `mark ${id}` },
      MARK_SYMBOLS[mark] ?? MARK_SYMBOLS[""],
    ),
    element("button", { ...button, ...discardLabel, [`data-${verb}`]: id, "data-key": `discard ${id}` }, sign),
  ];
}
