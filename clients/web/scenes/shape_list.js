// What a scene is made of: a list to choose from, and what is added, copied and taken away.
import { upload } from "../api.js";
import { block, element, option } from "../elements.js";
import {
  copyOf,
  meshExtent,
  newMesh,
  newShape,
  SHAPE_ROLES,
  shapeAt,
  shapesOf,
  withNewShape,
  withoutShape,
} from "./scene_draft.js";

/** @typedef {import("./scene_draft.js").Part} Part */
/** @typedef {import("./scene_draft.js").Place} Place */

/** @type {Record<Part, string>} */
const TITLES = {
  obstacles: "What stands there",
  carried: "The object where it lies",
  keep_in: "Zones that the arm stays inside",
  keep_out: "Zones that the arm stays out of",
};

const MAX_PIECES = 16; // of a mesh in convex pieces

/** What can be added: its words, the part that it belongs to, its kind, most pieces. @type {[string, Part, "box" | "cylinder" | "sphere" | "mesh", number?][]} */
const ADDITIONS = [
  ["a box", "obstacles", "box"],
  ["a cylinder", "obstacles", "cylinder"],
  ["a sphere", "obstacles", "sphere"],
  ["a mesh from a file", "obstacles", "mesh"],
  ["a hollow mesh, in pieces, from a file", "obstacles", "mesh", MAX_PIECES],
  ["a box to carry", "carried", "box"],
  ["a cylinder to carry", "carried", "cylinder"],
  ["a mesh to carry, from a file", "carried", "mesh"],
  ["a box to stay inside", "keep_in", "box"],
  ["a box to stay out of", "keep_out", "box"],
  ["a cylinder to stay out of", "keep_out", "cylinder"],
];
const NOT_CHOSEN = "Choose a shape in the list first.";

export class ShapeList {
  /**
   * @param {HTMLElement} place
   * @param {{scene: () => Scene | null, choose: (place: Place | null) => void,
   *          change: (scene: Scene, what: string, place: Place | null) => void,
   *          tell: (sentence: string) => void, attempt: Context["attempt"]}} editor
   */
  constructor(place, editor) {
    this.editor = editor;
    /** @type {Place | null} */
    this.chosen = null;
    this.list = element("select", { id: "scene-shapes", size: "8", "aria-label": "What the scene is made of" });
    this.kinds = element("select", { id: "shape-kind", "aria-label": "What to add" });
    this.kinds.append(...ADDITIONS.map(([text], k) => option(k, text)));
    this.addButton = element("button", { type: "button", id: "shape-add" }, "Add");
    this.copyButton = element("button", { type: "button", id: "shape-copy" }, "Duplicate");
    this.removeButton = element("button", { type: "button", id: "shape-remove" }, "Remove");
    this.file = element("input", {
      type: "file",
      hidden: "",
      accept: ".stl,.obj,.ply,.glb",
      "aria-label": "Mesh to add",
    });
    place.append(
      this.file,
      this.list,
      element("p", { class: "buttons" }, this.kinds, this.addButton, this.copyButton, this.removeButton),
    );
    this.list.addEventListener("change", () => editor.choose(placeOf(this.list.value)));
    this.addButton.addEventListener("click", () => this.#add());
    this.file.addEventListener("change", () => {
      const file = this.file.files?.[0];
      if (file) editor.attempt(() => this.#addMesh(file)).finally(() => (this.file.value = ""));
    });
    this.copyButton.addEventListener("click", () => this.#copy());
    this.removeButton.addEventListener("click", () => this.#remove());
  }

  /** @param {Scene | null} scene @param {Place | null} chosen */
  show(scene, chosen) {
    this.chosen = chosen;
    const groups = scene ? SHAPE_ROLES.map((part) => group(scene, part)).filter((one) => one.children.length) : [];
    const isSame = groups.map((one) => one.outerHTML).join("") === this.list.innerHTML;
    if (!isSame) this.list.replaceChildren(...groups);
    this.list.value = chosen ? placeKey(chosen) : "";
    for (const button of [this.copyButton, this.removeButton]) block(button, chosen ? "" : NOT_CHOSEN);
    block(this.addButton, scene ? "" : "The scene is not read yet.");
  }

  #add() {
    const [text, part, kind] = ADDITIONS[Number(this.kinds.value)];
    const scene = this.editor.scene();
    if (!scene) return;
    if (kind === "mesh") return this.file.click();
    const made = withNewShape(scene, part, newShape(scene, part, kind));
    this.editor.change(made.scene, `adding ${text}`, made.place);
  }

  /** @param {File} file whose convex hull or pieces the service reads */
  async #addMesh(file) {
    const [, part, , pieces = 1] = ADDITIONS[Number(this.kinds.value)];
    const name = this.editor.scene()?.name;
    /** @type {MeshHull} */
    const mesh = await upload(`meshes?name=${encodeURIComponent(file.name)}&max_pieces=${pieces}`, file);
    const scene = this.editor.scene();
    if (!scene || scene.name !== name) return; // another one is looked at meanwhile
    const shape = newMesh(scene, part, mesh);
    const made = withNewShape(scene, part, shape);
    this.editor.change(made.scene, `adding ${file.name}`, made.place);
    this.editor.tell(meshSentence(shape));
  }

  #copy() {
    const [scene, shape] = this.#current();
    if (!scene || !shape || !this.chosen) return;
    const part = this.chosen.part === "carried" ? "obstacles" : this.chosen.part; // there is one object
    const made = withNewShape(scene, part, copyOf(scene, shape));
    this.editor.change(made.scene, `duplicating ${shape.name}`, made.place);
  }

  #remove() {
    const [scene, shape] = this.#current();
    if (scene && shape && this.chosen)
      this.editor.change(withoutShape(scene, this.chosen), `taking ${shape.name} away`, null);
  }

  /** @returns {[Scene | null, Shape | null]} */
  #current() {
    const scene = this.editor.scene();
    return [scene, scene && shapeAt(scene, this.chosen)];
  }
}

/** @param {Shape} mesh */
function meshSentence(mesh) {
  const sizes = meshExtent(mesh).map((metres) => Number((1000 * metres).toPrecision(3)));
  const unit = mesh.size[0] === 1 ? "metres" : "millimetres";
  const place = mesh.pieces?.length ? `in ${mesh.pieces.length} convex pieces` : "as its convex hull";
  return `${mesh.file} is ${sizes.join(" × ")} mm, ${place}, when its numbers are ${unit}; "metres a unit" says otherwise.`;
}

/** @param {Place} place */
const placeKey = ({ part, index }) => `${part} ${index}`;

/** @param {string} value @returns {Place | null} */
function placeOf(value) {
  const [part, index] = value.split(" ");
  return value ? { part: /** @type {Part} */ (part), index: Number(index) } : null;
}

/** @param {Scene} scene @param {Part} part */
function group(scene, part) {
  const rows = shapesOf(scene, part).map(({ name, kind }, index) =>
    option(placeKey({ part, index }), name === kind ? name : `${name}, a ${kind}`),
  );
  return element("optgroup", { label: TITLES[part] }, rows);
}
