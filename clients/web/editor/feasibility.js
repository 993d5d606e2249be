// What the arm thinks of the draft: a sentence, the stretch that fails, what to move, and the colours along the curve.
import { drawing, element, number, replace, sentence } from "../elements.js";
import { movedBy } from "./curve_edits.js";
import { MEASURES, colouring, ends } from "./color_scale.js";

export function verdict(place, editor) {
  const told = element("div", { id: "edit-verdict", role: "status" });
  const measure = element("select", { id: "edit-measure", "aria-label": "what the colours show" });
  measure.append(...Object.entries(MEASURES).map(([name, { title }]) => element("option", { value: name }, title)));
  const scale = element("div", { class: "scale" });
  place.append(told, element("div", { class: "row" }, element("label", {}, "Colours of the curve ", measure)), scale);
  const paint = () => {
    const { assessment } = editor.verdict ?? {};
    editor.sketch.paint(assessment && colouring(assessment, MEASURES[measure.value]), assessment?.failure?.position);
    replace(scale, assessment ? legend(MEASURES[measure.value]) : "");
  };
  measure.addEventListener("change", paint);
  told.addEventListener("click", (event) => {
    const suggestion = event.target.closest("button") && editor.verdict?.assessment?.failure?.suggestion;
    if (!suggestion) return;
    editor.choose([suggestion.control_point]);
    editor.change(movedBy(editor.draft.curve, [suggestion.control_point], suggestion.move), `moving control point ${suggestion.control_point + 1} as proposed`);
  });

  return {
    update(editor, what) {
      if (!editor.draft || (what !== "verdict" && what !== "draft")) return;
      paint();
      replace(told, ...content(editor));
    },
  };
}

function content({ draft, verdict }) {
  if (!verdict || verdict.waiting) return [element("p", { class: "note" }, "The service is looking at the curve …")];
  if (verdict.refusal) return [element("p", { class: "failed" }, verdict.refusal)];
  const { failure, duration, sentence: outlook, lengths, clearance } = verdict.assessment;
  if (!failure) {
    const facts = `${number(lengths.at(-1), 3, "m")}, about ${number(duration, 2, "s")}, least clearance ${number(1000 * Math.min(...clearance), 0, "mm")}`;
    return [element("p", { class: "good" }, `${sentence(outlook)}.`), element("p", { class: "note" }, facts)];
  }
  const { interval, reason, suggestion } = failure;
  const pinned = draft.isPinned(suggestion.control_point);
  const size = Math.hypot(...suggestion.move);
  return [
    element("p", { class: "failed" }, `From ${number(interval[0], 3)} to ${number(interval[1], 3, "m")} the arm cannot follow: ${reason}.`),
    element("p", {}, `${sentence(suggestion.sentence)}.`),
    size > 0 &&
      element("p", { class: "orders" }, element("button", { type: "button", id: "edit-suggestion", "data-key": "suggestion", ...(pinned && { disabled: "" }) }, `Move control point ${suggestion.control_point + 1} by ${number(1000 * size, 0, "mm")}`)),
    size > 0 && pinned && element("p", { class: "note" }, "It is pinned; unlock start and goal first."),
  ];
}

// A bar of the scale with its ends, and what red means.
function legend({ unit, most }) {
  const stops = ends.stops.map((colour, i) => drawing("stop", { offset: String(i / (ends.stops.length - 1)), "stop-color": colour }));
  const bar = drawing(
    "svg",
    { viewBox: "0 0 100 8", preserveAspectRatio: "none", "aria-hidden": "true" },
    drawing("defs", {}, drawing("linearGradient", { id: "edit-scale" }, stops)),
    drawing("rect", { width: "100", height: "8", rx: "2", fill: "url(#edit-scale)" }),
  );
  const swatch = drawing("svg", { viewBox: "0 0 8 8", class: "swatch", "aria-hidden": "true" }, drawing("rect", { width: "8", height: "8", rx: "2", fill: ends.fails }));
  return element("div", { class: "legend", "aria-label": `scale from 0 to ${most} ${unit}; red where the arm fails` }, "0", bar, `${most}+ ${unit}`, swatch, "fails");
}
