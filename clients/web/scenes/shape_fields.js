// The chosen shape of a scene in numbers: name, colour, sizes and place in millimetres, turns in degrees.
import { element, hint } from "../elements.js";
import { isName, nameRefusal } from "../names.js";
import { numberInput, readNumber } from "../number_input.js";
import { capitalize } from "../texts.js";
import { namesIn } from "./scene_draft.js";
import { orientationOf, turnsOf } from "./turns.js";

/** What the numbers of a size are, of each kind. @type {Record<string, string[]>} */
const SIZES = {
  box: ["length x", "width y", "height z"],
  cylinder: ["radius", "height"],
  sphere: ["radius"],
  mesh: ["metres a unit"],
};
const AXES = ["x", "y", "z"];
export const MAX_LENGTH = 10_000; // [mm] the service accepts no more
const NO_SHAPE_SENTENCE =
  "Choose a shape in the list, or add one: its numbers stand here, and arrows in the view move it.";

/**
 * @typedef {import("./scene_draft.js").Part} Part
 * @typedef {object} NumberField
 * @property {HTMLInputElement} input
 * @property {HTMLLabelElement} label
 * @property {Text} caption
 * @property {(shape: Shape, part: Part | null) => string} name of the number; "": a shape of this kind has no such one
 * @property {(shape: Shape) => number | null} read null: the shape does not say it, and need not
 * @property {(shape: Shape, value: number) => Shape} write
 * @property {(shape: Shape) => Shape} [clear] the shape without the number, which may be left empty
 */

export class ShapeFields {
  /**
   * @param {HTMLElement} place
   * @param {{change: (shape: Shape, what: string) => void, refuse: (sentence: string) => void, scene: () => Scene | null}} editor
   */
  constructor(place, editor) {
    this.editor = editor;
    /** @type {Shape | null} */
    this.shape = null;
    /** @type {Part | null} */
    this.part = null;
    this.name = element("input", { type: "text", id: "shape-name", autocomplete: "off" });
    this.color = element("input", { type: "color", id: "shape-color" });
    this.numbers = [...sizeFields(), ...positionFields(), ...turnFields(), massField()];
    this.place = place;
    this.nothing = hint(NO_SHAPE_SENTENCE);
    this.parts = element(
      "div",
      {},
      element("p", { class: "field" }, element("label", { for: "shape-name" }, "Shape"), this.name, this.color),
      element(
        "div",
        { class: "fields thirds" },
        this.numbers.map(({ label }) => label),
      ),
    );
    place.append(this.nothing, this.parts);
    this.color.setAttribute("aria-label", "Colour");
    this.inputs.forEach(watchTyping);
    place.addEventListener("change", ({ target }) => {
      if (!(target instanceof HTMLInputElement) || !this.shape) return;
      delete target.dataset.typed;
      this.#enter(target, this.shape);
      this.show(this.shape, this.part); // what was refused is as it was
    });
  }

  get inputs() {
    return [this.name, this.color, ...this.numbers.map(({ input }) => input)];
  }

  /** @param {Shape | null} shape that is chosen @param {Part | null} part of the scene to which it belongs */
  show(shape, part) {
    const isOther = shape?.name !== this.shape?.name;
    this.shape = shape;
    this.part = part;
    this.nothing.hidden = shape !== null;
    this.parts.hidden = shape === null;
    this.color.hidden = part !== "obstacles" && part !== "carried"; // zones have that of their rule
    if (!shape) return;
    if (isOther) for (const input of this.inputs) delete input.dataset.typed;
    writeInput(this.name, shape.name);
    writeInput(this.color, `#${shape.color.toString(16).padStart(6, "0")}`);
    for (const { input, label, caption, name, read } of this.numbers) {
      const text = name(shape, part);
      label.hidden = text === "";
      if (caption.data !== text) caption.data = text;
      const value = read(shape);
      writeInput(input, text && value !== null ? String(Number(value.toFixed(4))) : "");
    }
  }

  /** @param {HTMLInputElement} input @param {Shape} shape */
  #enter(input, shape) {
    const { editor } = this;
    if (input === this.name) return this.#rename(shape, input.value.trim());
    if (input === this.color)
      return editor.change({ ...shape, color: Number.parseInt(input.value.slice(1), 16) }, `colour of ${shape.name}`);
    const field = this.numbers.find((one) => one.input === input);
    if (!field) return;
    const name = field.name(shape, this.part);
    if (input.value === "" && field.clear) return editor.change(field.clear(shape), `${name} of ${shape.name}`);
    const { value, fault } = readNumber(input);
    if (value === undefined) return editor.refuse(`${capitalize(name)} ${input.value || "is empty; it"} ${fault}.`);
    editor.change(field.write(shape, value), `${name} of ${shape.name}`);
  }

  /** @param {Shape} shape @param {string} wanted */
  #rename(shape, wanted) {
    const scene = this.editor.scene();
    if (wanted === shape.name || !scene) return;
    if (!isName(wanted)) return this.editor.refuse(`${nameRefusal("body of a scene", wanted)}.`);
    if (namesIn(scene).includes(wanted)) return this.editor.refuse(`There is a ${wanted} in this scene already.`);
    this.editor.change({ ...shape, name: wanted }, `name of ${shape.name}`);
  }
}

/** Note that somebody types in a field, until that is entered. @param {HTMLInputElement} input */
export const watchTyping = (input) => input.addEventListener("input", () => (input.dataset.typed = ""));

/** Show a value, unless somebody types another. @param {HTMLInputElement} input @param {string} value */
export function writeInput(input, value) {
  if (input === document.activeElement && "typed" in input.dataset) return; // whatever comes meanwhile
  if (input.value !== value) input.value = value;
}

/**
 * @param {string} id
 * @param {{min: number, max: number, unit?: string, placeholder?: string}} limits
 * @param {Omit<NumberField, "input" | "label" | "caption">} access
 * @returns {NumberField}
 */
function numberField(id, limits, access) {
  const input = numberInput({ id: `shape-${id}`, ...limits });
  const caption = document.createTextNode("");
  return { input, caption, label: element("label", {}, caption, input), ...access };
}

const sizeFields = () =>
  [0, 1, 2].map((k) =>
    numberField(
      `size-${k}`,
      { min: 0.0001, max: MAX_LENGTH },
      {
        name: ({ kind }) => (SIZES[kind]?.[k] ? `${SIZES[kind][k]}${kind === "mesh" ? "" : " (mm)"}` : ""),
        read: ({ kind, size }) => size[k] * unit(kind),
        write: (shape, value) => ({ ...shape, size: shape.size.with(k, value / unit(shape.kind)) }),
      },
    ),
  );

/** @param {string} kind whose size is written in millimetres, or as it is */
const unit = (kind) => (kind === "mesh" ? 1 : 1000);

const positionFields = () =>
  AXES.map((axis, k) =>
    numberField(
      `position-${axis}`,
      { min: -MAX_LENGTH, max: MAX_LENGTH, unit: "mm" },
      {
        name: () => `${axis} (mm)`,
        read: ({ position }) => 1000 * position[k],
        write: (shape, value) => ({ ...shape, position: asVector(shape.position.with(k, value / 1000)) }),
      },
    ),
  );

const turnFields = () =>
  AXES.map((axis, k) =>
    numberField(
      `turn-${axis}`,
      { min: -360, max: 360, unit: "°" },
      {
        name: () => `turn about ${axis} (°)`,
        read: ({ orientation }) => turnsOf(orientation)[k],
        write: (shape, value) => ({ ...shape, orientation: orientationOf(turnsOf(shape.orientation).with(k, value)) }),
      },
    ),
  );

/** The object's mass; left empty, it is that of its volume at 300 kg/m³. */
const massField = () =>
  numberField(
    "mass",
    { min: 0.0001, max: 100, unit: "kg", placeholder: "by volume" },
    {
      name: (_, part) => (part === "carried" ? "mass (kg)" : ""),
      read: ({ mass }) => mass ?? null,
      write: (shape, value) => ({ ...shape, mass: value }),
      clear: (shape) => ({ ...shape, mass: null }),
    },
  );

/** @param {number[]} values @returns {[number, number, number]} */
const asVector = ([x, y, z]) => [x, y, z];
