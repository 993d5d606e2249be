// Knots: more of them for finer edits, fewer for a calmer curve, a higher degree; the shape stays.
import { block, element } from "../elements.js";
import { numberInput, readNumber } from "../number_input.js";
import { formatNumber } from "../texts.js";
import { grevilleAbscissa, innerKnots, spanMidpoint } from "./curve_edits.js";

const MAX_DEGREE = 7;

/** @param {HTMLElement} place @param {Editor} editor @returns {EditorSection} */
export function knotsSection(place, editor) {
  const u = numberInput({
    id: "edit-u",
    min: 0,
    max: 1,
    step: 0.01,
    title: "place of the new knot, from 0 at the start to 1 at the goal",
  });
  const insert = element("button", { type: "button", id: "edit-insert" }, "Insert knot");
  const choice = element("select", { id: "edit-knot" });
  const allowed = numberInput({
    id: "edit-allowed",
    min: 0.001,
    max: 100,
    unit: "mm",
    value: "0.001",
    title: "how far the curve may move",
  });
  const remove = element("button", { type: "button", id: "edit-remove" }, "Remove knot");
  const elevate = element("button", { type: "button", id: "edit-elevate" }, "Raise degree");
  const about = element("p", { class: "note", id: "edit-curve" });
  place.append(
    about,
    element(
      "p",
      { class: "note" },
      "More knots make room for finer edits, fewer make a calmer curve. Inserting and raising the degree never change the shape.",
    ),
    element("div", { class: "row" }, element("label", {}, "At u ", u), insert, elevate),
    element(
      "div",
      { class: "row" },
      element("label", {}, "Knot ", choice),
      element("label", {}, "off by (mm) ", allowed),
      remove,
    ),
  );
  /** @param {string} operation @param {object} more @param {string} what */
  const operate = (operation, more, what) =>
    editor.context.attempt(async () => {
      const done = await editor.applyOperation(operation, more, what);
      if (done) editor.context.messages.show(`${what}: the curve moved by ${formatDistance(done.deviation)}.`);
    });
  /** @param {HTMLInputElement} input @param {string} name @returns {number | null} null: it is said what is wrong */
  const entered = (input, name) => {
    const { value, fault } = readNumber(input);
    if (value === undefined)
      editor.context.messages.show(`${name} ${input.value || "is empty; it"} ${fault}.`, "error");
    return value ?? null;
  };
  insert.addEventListener("click", () => {
    const at = entered(u, "The place of a knot");
    if (at !== null) operate("insert-knot", { u: at }, `Knot inserted at u = ${at}`);
  });
  remove.addEventListener("click", () => {
    const [at, most] = [Number(choice.value), entered(allowed, "How far the curve may move")];
    if (most === null) return;
    operate("remove-knot", { u: at, tolerance: most / 1000 }, `Knot removed at u = ${Number(at.toPrecision(4))}`);
  });
  elevate.addEventListener("click", () =>
    operate("elevate", {}, `Degree raised to ${(editor.draft?.curve.degree ?? 0) + 1}`),
  );

  let proposed = { value: "", of: "" }; // what was proposed for u, and for which choice of control points

  return {
    update({ draft }, what) {
      if (!draft || what === "drag" || what === "feasibility" || what === "versions") return;
      const { curve } = draft;
      const inner = innerKnots(curve);
      about.textContent = `Degree ${curve.degree}, ${curve.control_points.length} control points, ${inner.length} inner ${inner.length === 1 ? "knot" : "knots"}.`;
      const kept = choice.value;
      choice.replaceChildren(
        ...inner.map(({ u, times }) =>
          element("option", { value: String(u) }, formatNumber(u, 4) + (times > 1 ? ` ×${times}` : "")),
        ),
      );
      if ([...choice.options].some(({ value }) => value === kept)) choice.value = kept;
      const none = inner.length ? "" : "The curve has no knot inside.";
      block(remove, none);
      block(choice, none, "knots inside the curve");
      block(elevate, curve.degree >= MAX_DEGREE ? `${MAX_DEGREE} is the highest degree.` : "");
      const around = draft.selected.length === 1 ? grevilleAbscissa(curve, draft.selected[0]) : 0.5;
      // What was typed stays until other points are chosen.
      const of = `${draft.path} ${draft.selected}`;
      if (document.activeElement === u || (u.value !== proposed.value && of === proposed.of)) return;
      u.value = String(Number(spanMidpoint(curve, around).toFixed(6)));
      proposed = { value: u.value, of };
    },
  };
}

/** @param {number} metres */
function formatDistance(metres) {
  return metres < 1e-8 ? "less than 0.00001 mm" : `${Number((1000 * metres).toPrecision(2))} mm`;
}
