// The draft of a scene: the scene as it is edited, the version it began from, and the steps of undo. Positions in robot
// coordinates [m]. The service knows nothing of it before it is saved.

/**
 * @typedef {"obstacles" | "carried" | "keep_in" | "keep_out"} Part
 * @typedef {{part: Part, index: number}} Place of a shape in a scene
 * @typedef {{base: number, original: Scene}} Origin number of the version that is edited, and its scene
 * @typedef {{scene: Scene, what: string, origin?: Origin}} Step what was before it, and its name; the origin where it changed
 */

/** @type {Part[]} */
export const SHAPE_ROLES = ["obstacles", "carried", "keep_in", "keep_out"];
const SIZES = { box: [0.1, 0.1, 0.1], cylinder: [0.05, 0.1], sphere: [0.05] }; // of what is new [m]
const OBJECT_SIZES = { box: [0.04, 0.04, 0.04], cylinder: [0.02, 0.06], sphere: [0.02] }; // between the gripper's fingers [m]
const CAGE_SIZE = [3, 3, 3]; // around any arm that stands on the floor [m]
const LARGEST_IN_METRES = 10; // a mesh with a larger extent has millimetres for units
const BESIDE_THE_ARM = 0.5; // ahead of it [m]
const COLORS = { obstacles: 0x7c8896, carried: 0xe8c547, keep_in: 0x2a8f5a, keep_out: 0xd62718 };
/** @type {Record<Part, string>} */
const NAMES = { obstacles: "", carried: "object", keep_in: "cage", keep_out: "zone" }; // "": that of its kind

export class SceneDraft {
  /** @type {Step[]} */
  #past = [];
  /** @type {Step[]} */
  #future = [];

  /** @param {SavedScene} saved the version that it begins from */
  constructor({ version, scene }) {
    this.name = scene.name;
    this.base = version.number;
    this.original = scene;
    this.scene = scene;
  }

  get isEdited() {
    return !areEqual(this.scene, this.original);
  }

  get undoLabel() {
    return this.#past.at(-1)?.what ?? "";
  }

  get redoLabel() {
    return this.#future.at(-1)?.what ?? "";
  }

  /** Make one step. @param {Scene} scene @param {string} what names it for undo and redo */
  change(scene, what) {
    if (areEqual(scene, this.scene)) return;
    this.#past.push({ scene: this.scene, what });
    this.#future = [];
    this.scene = scene;
  }

  undo() {
    this.#step(this.#past, this.#future);
  }

  redo() {
    this.#step(this.#future, this.#past);
  }

  /** Go on from another version; what was changed stays one step back, with the version that it was changed from. @param {Origin} origin @param {string} what */
  rebase(origin, what) {
    const former = { base: this.base, original: this.original };
    Object.assign(this, origin);
    if (areEqual(origin.original, this.scene)) return;
    this.change(origin.original, what);
    this.#past[this.#past.length - 1].origin = former; // lest mine be saved as made from theirs
  }

  /** Be as the version was; what was changed stays one step back. */
  revert() {
    this.change(this.original, "going back to the version");
  }

  /** A scene has been saved as this version; the draft may be a step further by now. @param {number} number @param {Scene} scene */
  saved(number, scene) {
    this.base = number;
    this.original = scene;
  }

  /** @param {Step[]} from @param {Step[]} to */
  #step(from, to) {
    const step = from.pop();
    if (!step) return;
    to.push({
      scene: this.scene,
      what: step.what,
      origin: step.origin && { base: this.base, original: this.original },
    });
    if (step.origin) Object.assign(this, step.origin);
    this.scene = step.scene;
  }
}

/** @param {Scene} a @param {Scene} b */
const areEqual = (a, b) => a === b || JSON.stringify(a) === JSON.stringify(b);

/** The shapes of a part; the object is one, or none. @param {Scene} scene @param {Part} part @returns {Shape[]} */
export function shapesOf(scene, part) {
  if (part === "carried") return scene.carried ? [scene.carried] : [];
  return scene[part];
}

/** The shape at a place; null where there is none. @param {Scene | null} scene @param {Place | null} place */
export const shapeAt = (scene, place) => (scene && place ? (shapesOf(scene, place.part)[place.index] ?? null) : null);

/** @param {Scene} scene @param {Part} part @param {Shape[]} shapes */
const withShapes = (scene, part, shapes) => ({ ...scene, [part]: part === "carried" ? (shapes[0] ?? null) : shapes });

/** A scene with another shape at a place. @param {Scene} scene @param {Place} place @param {Shape} shape @returns {Scene} */
export const withShape = (scene, { part, index }, shape) =>
  withShapes(scene, part, shapesOf(scene, part).with(index, shape));

/** @param {Scene} scene @param {Place} place @returns {Scene} */
export const withoutShape = (scene, { part, index }) =>
  withShapes(
    scene,
    part,
    shapesOf(scene, part).filter((_, k) => k !== index),
  );

/**
 * A scene with one shape more, and where that is; the object that is there gives way to another.
 * @param {Scene} scene
 * @param {Part} part
 * @param {Shape} shape
 * @returns {{scene: Scene, place: Place}}
 */
export function withNewShape(scene, part, shape) {
  const shapes = part === "carried" ? [shape] : [...shapesOf(scene, part), shape];
  return { scene: withShapes(scene, part, shapes), place: { part, index: shapes.length - 1 } };
}

/**
 * A shape to begin with: it lies on the first thing that stands in the scene, the table as a rule; a cage is around the arm.
 * @param {Scene} scene
 * @param {Part} part
 * @param {"box" | "cylinder" | "sphere"} kind
 * @returns {Shape}
 */
export function newShape(scene, part, kind) {
  const size = part === "keep_in" ? CAGE_SIZE : (part === "carried" ? OBJECT_SIZES : SIZES)[kind];
  const half = kind === "sphere" ? size[0] : size[size.length - 1] / 2;
  const [x, y, ground] = part === "keep_in" ? [0, 0, scene.floor] : restingPlace(scene);
  const name = freeName(scene, NAMES[part] || kind);
  const orientation = /** @type {Shape["orientation"]} */ ([1, 0, 0, 0]);
  return {
    name,
    kind,
    size,
    position: [x, y, ground + half],
    color: COLORS[part],
    orientation,
    file: "",
    vertices: [],
    mass: null,
    max_pieces: 1,
    pieces: [],
  };
}

/**
 * A mesh from a file: it stands on the first thing in the scene; the file does not say in which unit it is.
 * @param {Scene} scene
 * @param {Part} part
 * @param {MeshHull} mesh
 * @returns {Shape}
 */
export function newMesh(scene, part, { file, vertices, max_pieces, pieces }) {
  const [low, high] = extremes(vertices);
  const unit = Math.max(...high.map((value, k) => value - low[k])) > LARGEST_IN_METRES ? 0.001 : 1;
  const [x, y, ground] = restingPlace(scene);
  const middle = low.map((value, k) => (value + high[k]) / 2);
  return {
    name: freeName(scene, nameOfFile(file)),
    kind: "mesh",
    size: [unit],
    position: [x - unit * middle[0], y - unit * middle[1], ground - unit * low[2]],
    color: COLORS[part],
    orientation: [1, 0, 0, 0],
    file,
    vertices,
    mass: null,
    max_pieces,
    pieces,
  };
}

/** How large a mesh is along its own axes [m]. @param {Shape} shape */
export function meshExtent({ size: [unit], vertices }) {
  const [low, high] = extremes(vertices);
  return high.map((value, k) => unit * (value - low[k]));
}

/** The least and the largest of each coordinate. @param {Point[]} points */
function extremes(points) {
  const low = [Infinity, Infinity, Infinity];
  const high = [-Infinity, -Infinity, -Infinity];
  for (const point of points)
    for (const k of [0, 1, 2]) {
      low[k] = Math.min(low[k], point[k]);
      high[k] = Math.max(high[k], point[k]);
    }
  return [low, high];
}

/** A name for what a file holds: the file's own, as far as it may be one. @param {string} file */
function nameOfFile(file) {
  const stem = file.replace(/\.[^.]*$/, "").replace(/[^A-Za-z0-9]+/g, "-");
  return stem.replace(/^-|-$/g, "").slice(0, 60) || "mesh";
}

/** The middle of the table's top, or a place on the floor. @param {Scene} scene @returns {[number, number, number]} */
function restingPlace({ obstacles: [table], floor }) {
  if (table?.kind !== "box") return [BESIDE_THE_ARM, 0, floor];
  const [x, y, z] = table.position;
  return [x, y, z + table.size[2] / 2];
}

/** A shape beside another that is the same, with a name of its own. @param {Scene} scene @param {Shape} shape @returns {Shape} */
export function copyOf(scene, shape) {
  const [x, y, z] = shape.position;
  return { ...shape, name: freeName(scene, shape.name), position: [x, y + 0.1, z] };
}

/** The names of all shapes. @param {Scene} scene */
export const namesIn = (scene) => SHAPE_ROLES.flatMap((part) => shapesOf(scene, part).map(({ name }) => name));

/** A name that no shape has, by a number behind it where there is one. @param {Scene} scene @param {string} wanted */
export function freeName(scene, wanted) {
  const taken = new Set(namesIn(scene));
  const stem = wanted.replace(/-\d+$/, "");
  for (let number = 2, name = wanted; ; number += 1) {
    if (!taken.has(name)) return name;
    name = `${stem}-${number}`;
  }
}

/**
 * What the service is asked to save.
 * @param {Scene} scene
 * @param {{base: number, author: string, note: string}} details
 */
export function sceneBody({ obstacles, carried, floor, keep_in, keep_out, display_name }, details) {
  return { obstacles, carried, floor, keep_in, keep_out, display_name, ...details };
}
