// Whether the arm can follow the draft: a sentence, the segment that fails, what to move, and the colors along the curve.
import { blocked, closest, element, svgElement } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { capitalize, formatLength, formatNumber } from "../texts.js";
import { colorFunction, legendColors, METRICS } from "./color_scale.js";
import { movePoints } from "./curve_edits.js";

const PINNED_SENTENCE = "It is pinned; unlock start and goal first.";

/** @param {HTMLElement} place @param {Editor} editor @returns {EditorSection} */
export function feasibilitySection(place, editor) {
  const status = element("div", { id: "edit-feasibility", role: "status" });
  const metric = element("select", { id: "edit-metric", "aria-label": "what the colors show" });
  metric.append(...Object.entries(METRICS).map(([name, { title }]) => element("option", { value: name }, title)));
  const scale = element("div", { class: "scale" });
  place.append(status, element("div", { class: "row" }, element("label", {}, "Colours of the curve ", metric)), scale);
  const paint = () => {
    const { assessment } = editor.feasibility ?? {};
    editor.curveOverlay.setColors(
      assessment ? colorFunction(assessment, METRICS[metric.value]) : null,
      assessment?.failure?.position,
    );
    patchChildren(scale, assessment ? legend(METRICS[metric.value]) : "");
  };
  metric.addEventListener("change", paint);
  status.addEventListener("click", (event) => {
    const suggestion = closest(event, "button") && editor.feasibility?.assessment?.failure?.suggestion;
    if (!suggestion || !editor.draft) return;
    editor.select([suggestion.control_point]);
    editor.change(
      movePoints(editor.draft.curve, [suggestion.control_point], suggestion.move),
      `moving control point ${suggestion.control_point + 1} as proposed`,
    );
  });

  return {
    update(editor, what) {
      if (!editor.draft || (what !== "feasibility" && what !== "draft")) return;
      paint();
      patchChildren(status, ...content(editor));
    },
  };
}

/** @param {Editor} editor @returns {Child[]} */
function content({ draft, feasibility }) {
  if (feasibility?.error) return [element("p", { class: "failed" }, feasibility.error)];
  if (!feasibility?.assessment) return [element("p", { class: "note" }, "The service is assessing the curve …")];
  const { failure, duration, sentence: outlook, lengths, clearance } = feasibility.assessment;
  if (!failure) {
    const [length, least] = [lengths[lengths.length - 1], Math.min(...clearance)];
    const time = duration === null ? "" : `, in about ${formatNumber(duration, 2, "s")}`;
    const facts = `${formatNumber(length, 3, "m")}${time}, least clearance ${formatLength(least)}`;
    return [
      element("p", { class: "good" }, `The arm can probably follow: ${facts}. Certify it to be sure.`),
      element(
        "details",
        {},
        element("summary", {}, "Figures"),
        element("p", { class: "note" }, `${capitalize(outlook)}.`),
      ),
    ];
  }
  const { interval, reason, suggestion } = failure;
  const pinned = draft?.isPinned(suggestion.control_point);
  const size = Math.hypot(...suggestion.move);
  return [
    element(
      "p",
      { class: "failed" },
      `From ${formatNumber(interval[0], 3)} to ${formatNumber(interval[1], 3, "m")} the arm cannot follow: ${reason}.`,
    ),
    element("p", {}, `${capitalize(suggestion.sentence)}.`),
    size > 0 &&
      element(
        "p",
        { class: "buttons" },
        element(
          "button",
          {
            type: "button",
            id: "edit-suggestion",
            "data-key": "suggestion",
            ...blocked(pinned ? PINNED_SENTENCE : ""),
          },
          `Move control point ${suggestion.control_point + 1} by ${formatLength(size)}`,
        ),
      ),
    size > 0 && pinned && element("p", { class: "note" }, PINNED_SENTENCE),
  ];
}

/**
 * A bar of the scale with its ends, and what red means.
 * @param {import("./color_scale.js").Metric} metric
 */
function legend({ unit, max }) {
  const stops = legendColors.stops.map((color, i) =>
    svgElement("stop", { offset: String(i / (legendColors.stops.length - 1)), "stop-color": color }),
  );
  const bar = svgElement(
    "svg",
    { viewBox: "0 0 100 8", preserveAspectRatio: "none", "aria-hidden": "true" },
    svgElement("defs", {}, svgElement("linearGradient", { id: "edit-scale" }, stops)),
    svgElement("rect", { width: "100", height: "8", rx: "2", fill: "url(#edit-scale)" }),
  );
  const swatch = svgElement(
    "svg",
    { viewBox: "0 0 8 8", class: "swatch", "aria-hidden": "true" },
    svgElement("rect", { width: "8", height: "8", rx: "2", fill: legendColors.fails }),
  );
  return element(
    "div",
    { class: "legend", "aria-label": `scale from 0 to ${max} ${unit}; red where the arm fails` },
    "0",
    bar,
    `${max}+ ${unit}`,
    swatch,
    "fails",
  );
}
