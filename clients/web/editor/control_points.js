// The control points in numbers: a list to choose from, coordinates in millimetres, the weight, and the pins.
import { element } from "../elements.js";
import { movedBy, withPoint, withWeights } from "./curve_edits.js";

const AXES = ["x", "y", "z"];
const LIMIT = 10_000; // [mm] the service accepts no more
const SPACE = "\u00a0"; // an option runs plain ones together
const WEIGHTS = { min: "0.001", max: "1000" };

export function points(place, editor) {
  const list = element("select", { multiple: "", size: "7", id: "edit-points", "aria-label": "control points, several may be chosen" });
  const fields = AXES.map((axis) => field(axis, `${axis} in millimetres`, { min: String(-LIMIT), max: String(LIMIT), step: "0.1" }));
  const weight = field("weight", "weight", { ...WEIGHTS, step: "any" });
  const pins = element("input", { type: "checkbox", id: "edit-unlock" });
  const told = element("p", { class: "note", id: "edit-chosen" });
  place.append(
    list,
    told,
    element("div", { class: "fields" }, [...fields, weight].map(({ label }) => label)),
    element("label", { class: "check" }, pins, "Unlock start and goal"),
  );
  const inputs = [...fields, weight].map(({ input }) => input);
  for (const input of inputs) input.addEventListener("input", () => (input.dataset.typed = "")); // until it is entered
  list.addEventListener("change", () => editor.choose([...list.selectedOptions].map((option) => Number(option.value))));
  pins.addEventListener("change", () => editor.unlock(pins.checked));
  place.addEventListener("change", (event) => {
    const at = inputs.indexOf(event.target);
    if (at < 0) return;
    delete event.target.dataset.typed;
    if (event.target.value === "" || !event.target.checkValidity()) {
      editor.context.messages.say(`The ${at < 3 ? AXES[at] : "weight"} ${event.target.value || "is empty; it"} must be a number from ${event.target.min} to ${event.target.max}.`, "error");
      fill(editor, fields, weight);
    } else enter(editor, at, Number(event.target.value));
  });

  return {
    update(editor, what) {
      if (!editor.draft || what === "verdict" || what === "versions") return;
      const { draft } = editor;
      if (what !== "drag") write(list, draft);
      pins.checked = draft.unlocked;
      told.textContent = chosenInWords(draft);
      fill(editor, fields, weight);
    },
  };
}

function field(name, label, limits) {
  const input = element("input", { type: "number", id: `edit-${name}`, "aria-label": label, ...limits });
  return { input, label: element("label", {}, name === "weight" ? "weight" : `${name} (mm)`, input) };
}

// What is typed for one point is its place; for several it moves them all by what their middle lacks.
function enter(editor, at, value) {
  const { draft } = editor;
  if (at === 3) return editor.change(withWeights(draft.curve, draft.chosen, value), `weight ${value}`);
  if (draft.chosen.some((index) => draft.isPinned(index))) return editor.context.messages.say("Start and goal are pinned. Unlock them to move them.");
  const metres = value / 1000;
  if (draft.chosen.length === 1) {
    const [index] = draft.chosen;
    const point = draft.curve.control_points[index].map((old, axis) => (axis === at ? metres : old));
    return editor.change(withPoint(draft.curve, index, point), `${AXES[at]} of control point ${index + 1}`);
  }
  const by = [0, 0, 0].map((_, axis) => (axis === at ? metres - editor.middle[axis] : 0));
  return editor.change(movedBy(draft.curve, draft.chosen, by), `${AXES[at]} of ${draft.chosen.length} control points`);
}

function write(list, draft) {
  const lines = draft.curve.control_points.map((point, i) => {
    const role = i === 0 ? "start" : i === draft.last ? "goal" : "";
    const pin = draft.isPinned(i) ? " (pinned)" : "";
    const weight = draft.curve.weights[i] === 1 ? "" : ` weight ${Number(draft.curve.weights[i].toPrecision(4))}`;
    const places = point.map((value) => (1000 * value).toFixed(1).padStart(8, SPACE)).join("");
    return `${String(i + 1).padStart(2, SPACE)}${places}${SPACE}${SPACE}${role}${pin}${weight}`;
  });
  while (list.options.length > lines.length) list.lastChild.remove();
  lines.forEach((line, i) => {
    if (!list.options[i]) list.append(element("option", { value: String(i) }));
    if (list.options[i].textContent !== line) list.options[i].textContent = line;
    list.options[i].selected = draft.chosen.includes(i);
  });
}

function chosenInWords({ chosen }) {
  if (!chosen.length) return "Choose a control point here, or click it in the view. Shift adds; Shift and a drag on free space choose with a box.";
  return chosen.length === 1 ? `Control point ${chosen[0] + 1}` : `${chosen.length} control points; coordinates are those of their middle`;
}

function fill({ draft, middle }, fields, weight) {
  const { chosen, curve } = draft;
  fields.forEach(({ input }, axis) => show(input, middle ? Number((1000 * middle[axis]).toFixed(2)) : "", !middle));
  const weights = new Set(chosen.map((i) => curve.weights[i]));
  show(weight.input, weights.size === 1 ? Number([...weights][0].toPrecision(6)) : "", !chosen.length);
}

function show(input, value, disabled) {
  if (input === document.activeElement && "typed" in input.dataset) return; // whatever comes meanwhile
  input.disabled = disabled;
  if (input.value !== String(value)) input.value = String(value);
}
