// The control points in numbers: a list to choose from, coordinates in millimetres, the weight, and the pins.
import { block, element } from "../elements.js";
import { numberInput, readNumber } from "../number_input.js";
import { movePoints, setPoint, setWeights } from "./curve_edits.js";

/** @typedef {{input: HTMLInputElement, label: HTMLLabelElement}} Field */

const AXES = ["x", "y", "z"];
const MAX_COORDINATE = 10_000; // [mm] the service accepts no more
const NO_BREAK_SPACE = "\u00a0"; // an option collapses plain ones
const WEIGHT_RANGE = { min: 0.001, max: 1000 };

/** @param {HTMLElement} place @param {Editor} editor @returns {EditorSection} */
export function controlPointsSection(place, editor) {
  const list = element("select", {
    multiple: "",
    size: "7",
    id: "edit-points",
    "aria-label": "control points, several may be chosen",
  });
  const fields = AXES.map((axis) =>
    field(axis, `${axis} in millimetres`, { min: -MAX_COORDINATE, max: MAX_COORDINATE, unit: "mm" }),
  );
  const weight = field("weight", "weight", WEIGHT_RANGE);
  const pins = element("input", { type: "checkbox", id: "edit-unlock" });
  const status = element("p", { class: "note", id: "edit-selection" });
  place.append(
    list,
    status,
    element(
      "div",
      { class: "fields" },
      [...fields, weight].map(({ label }) => label),
    ),
    element("label", { class: "check" }, pins, "Unlock start and goal"),
  );
  const inputs = [...fields, weight].map(({ input }) => input);
  for (const input of inputs) input.addEventListener("input", () => (input.dataset.typed = "")); // until it is entered
  list.addEventListener("change", () => editor.select([...list.selectedOptions].map((option) => Number(option.value))));
  pins.addEventListener("change", () => editor.unlock(pins.checked));
  place.addEventListener("change", (event) => {
    const input = inputs.find((one) => one === event.target);
    if (!input) return;
    const at = inputs.indexOf(input);
    delete input.dataset.typed;
    const { value, fault } = readNumber(input);
    if (value === undefined) {
      const name = at < 3 ? AXES[at] : "weight";
      editor.context.messages.show(`The ${name} ${input.value || "is empty; it"} ${fault}.`, "error");
    } else applyInput(editor, at, value);
    writeFields(editor, fields, weight); // as it is now: a number in its own unit, or what was refused
  });

  return {
    update(editor, what) {
      if (!editor.draft || what === "feasibility" || what === "versions") return;
      const { draft } = editor;
      if (what !== "drag") writeList(list, draft);
      pins.checked = draft.unlocked;
      status.textContent = selectionText(draft);
      writeFields(editor, fields, weight);
    },
  };
}

/** @param {string} name @param {string} label @param {{min: number, max: number, unit?: string}} limits */
function field(name, label, limits) {
  const input = numberInput({ id: `edit-${name}`, "aria-label": label, ...limits });
  return { input, label: element("label", {}, name === "weight" ? "weight" : `${name} (mm)`, input) };
}

/**
 * A coordinate of one point is its own; that of several is their centre's, and moves them all.
 * @param {Editor} editor
 * @param {number} at axis, or 3 for the weight
 * @param {number} value
 */
function applyInput(editor, at, value) {
  const { draft, selectionCenter } = editor;
  if (!draft || !selectionCenter) return;
  if (at === 3) return editor.change(setWeights(draft.curve, draft.selected, value), `weight ${value}`);
  if (draft.selected.some((index) => draft.isPinned(index)))
    return editor.context.messages.show("Start and goal are pinned. Unlock them to move them.");
  const metres = value / 1000;
  if (draft.selected.length === 1) {
    const [index] = draft.selected;
    const point = draft.curve.control_points[index].map((old, axis) => (axis === at ? metres : old));
    return editor.change(setPoint(draft.curve, index, point), `${AXES[at]} of control point ${index + 1}`);
  }
  const by = [0, 0, 0].map((_, axis) => (axis === at ? metres - selectionCenter[axis] : 0));
  return editor.change(
    movePoints(draft.curve, draft.selected, by),
    `${AXES[at]} of ${draft.selected.length} control points`,
  );
}

/** @param {HTMLSelectElement} list @param {import("./draft.js").Draft} draft */
function writeList(list, draft) {
  const lines = draft.curve.control_points.map((point, i) => {
    const role = i === 0 ? "start" : i === draft.last ? "goal" : "";
    const pin = draft.isPinned(i) ? " (pinned)" : "";
    const weight = draft.curve.weights[i] === 1 ? "" : ` weight ${Number(draft.curve.weights[i].toPrecision(4))}`;
    const places = point.map((value) => (1000 * value).toFixed(1).padStart(8, NO_BREAK_SPACE)).join("");
    return `${String(i + 1).padStart(2, NO_BREAK_SPACE)}${places}${NO_BREAK_SPACE}${NO_BREAK_SPACE}${role}${pin}${weight}`;
  });
  while (list.options.length > lines.length) list.lastChild?.remove();
  lines.forEach((line, i) => {
    if (!list.options[i]) list.append(element("option", { value: String(i) }));
    if (list.options[i].textContent !== line) list.options[i].textContent = line;
    list.options[i].selected = draft.selected.includes(i);
  });
}

/** @param {import("./draft.js").Draft} draft */
function selectionText({ selected }) {
  if (!selected.length)
    return "Choose a control point here, or click it in the view. Shift adds; Shift and a drag on free space choose with a box.";
  return selected.length === 1
    ? `Control point ${selected[0] + 1}`
    : `${selected.length} control points; coordinates are those of their middle`;
}

/** @param {Editor} editor @param {Field[]} fields @param {Field} weight */
function writeFields({ draft, selectionCenter }, fields, weight) {
  if (!draft) return;
  const { selected, curve } = draft;
  for (const [axis, { input }] of fields.entries()) {
    writeField(input, selectionCenter ? Number((1000 * selectionCenter[axis]).toFixed(2)) : "", !selectionCenter);
  }
  const weights = new Set(selected.map((i) => curve.weights[i]));
  writeField(weight.input, weights.size === 1 ? Number([...weights][0].toPrecision(6)) : "", !selected.length);
}

/** @param {HTMLInputElement} input @param {string | number} value @param {boolean} disabled */
function writeField(input, value, disabled) {
  if (input === document.activeElement && "typed" in input.dataset) return; // whatever comes meanwhile
  block(input, disabled ? "Choose a control point first." : "");
  if (input.value !== String(value)) input.value = String(value);
}
