// Where touched places put things: corners to touch, a scene moved as a whole, a shape placed by three points. Robot coordinates [m].
import { SHAPE_ROLES, shapesOf, withShape } from "../scenes/scene_draft.js";

/** @typedef {[number, number, number]} Vector */
/** @typedef {[number, number, number, number]} Quaternion unit, w, x, y, z */

const LEAST_LENGTH = 0.005; // [m] between touched points, and of the third from the line through the others

/** @param {number[]} a @param {number[]} b @returns {Vector} */
const sum = ([a, b, c], [d, e, f]) => [a + d, b + e, c + f];
/** @param {number[]} a @param {number} k @returns {Vector} */
const scaled = ([a, b, c], k) => [k * a, k * b, k * c];
/** @param {number[]} a @param {number[]} b @returns {Vector} */
const difference = (a, b) => sum(a, scaled(b, -1));
/** @param {number[]} a @param {number[]} b */
const dot = ([a, b, c], [d, e, f]) => a * d + b * e + c * f;
/** @param {number[]} a @param {number[]} b @returns {Vector} */
const cross = ([a, b, c], [d, e, f]) => [b * f - c * e, c * d - a * f, a * e - b * d];

/** How far two places are from each other [m]. @param {number[]} a @param {number[]} b */
export const distance = (a, b) => Math.hypot(...difference(a, b));

/** @param {number[]} left @param {number[]} right @returns {Quaternion} */
export function product([a, b, c, d], [e, f, g, h]) {
  return [
    a * e - b * f - c * g - d * h,
    a * f + b * e + c * h - d * g,
    a * g - b * h + c * e + d * f,
    a * h + b * g - c * f + d * e,
  ];
}

/** @param {number[]} turn unit quaternion w, x, y, z @param {number[]} vector @returns {Vector} */
export function rotated(turn, vector) {
  const [w, ...axis] = turn;
  const side = scaled(cross(axis, vector), 2);
  return sum(sum(vector, scaled(side, w)), cross(axis, side));
}

/** Where a calibration puts a place. @param {Calibration} calibration @param {number[]} place @returns {Vector} */
export const mapped = ({ scale, rotation, offset }, place) => sum(scaled(rotated(rotation, place), scale), offset);

/** The corners of a box's upper face, one beside the other. @param {Shape} box @returns {Vector[]} */
export function topCorners({ position, orientation, size: [x, y, z] }) {
  const signs = [
    [-1, -1],
    [1, -1],
    [1, 1],
    [-1, 1],
  ];
  return signs.map(([a, b]) => sum(position, rotated(orientation, [(a * x) / 2, (b * y) / 2, z / 2])));
}

/**
 * A scene with all that stands in it moved as one; its floor stays.
 * @param {Scene} scene
 * @param {Calibration} motion maps where things were to where they are
 */
export function movedScene(scene, motion) {
  let moved = scene;
  for (const part of SHAPE_ROLES)
    for (const [index, shape] of shapesOf(scene, part).entries())
      moved = withShape(moved, { part, index }, movedShape(shape, motion));
  return moved;
}

/** @param {Shape} shape @param {Calibration} motion @returns {Shape} */
const movedShape = (shape, motion) => ({
  ...shape,
  position: mapped(motion, shape.position),
  orientation: product(motion.rotation, shape.orientation),
});

/** What is touched, in turn, to place a shape of a kind. @type {Record<string, [string, string, string]>} */
export const THREE_POINTS = {
  box: [
    "a corner of its top",
    "the corner at the other end of its length x",
    "another point of its top, on the side of y",
  ],
  cylinder: ["a point on its upper rim", "another point on the rim", "a third point on the rim"],
  mesh: ["the origin of its file", "a point on its x axis", "a point beside that axis, on the side of y"],
};

/**
 * A shape where three touched points say that it is; a cylinder is as wide as its rim.
 * @param {Shape} shape
 * @param {number[][]} points see THREE_POINTS
 * @returns {Shape}
 */
export function placedByTouch(shape, [first, second, third]) {
  const along = difference(second, first);
  const beside = difference(third, first);
  const normal = cross(along, beside);
  const length = Math.hypot(...along);
  const area = Math.hypot(...normal);
  if (length < LEAST_LENGTH || area < LEAST_LENGTH * length)
    throw new Error("The three points are too near to each other or to one line: touch them again, farther apart.");
  if (shape.kind === "cylinder") return cylinderOnRim(shape, first, { along, beside, normal });
  const z = scaled(normal, 1 / area);
  const x = scaled(along, 1 / length);
  const orientation = quaternionOf(x, cross(z, x), z);
  const [a, b, c] = shape.size;
  const center = shape.kind === "box" ? [a / 2, b / 2, -c / 2] : [0, 0, 0];
  return { ...shape, orientation, position: sum(first, rotated(orientation, center)) };
}

/** @param {Shape} shape @param {number[]} first @param {{along: Vector, beside: Vector, normal: Vector}} rim */
function cylinderOnRim(shape, first, { along, beside, normal }) {
  const squared = dot(normal, normal);
  const toCenter = scaled(
    sum(scaled(cross(normal, along), dot(beside, beside)), scaled(cross(beside, normal), dot(along, along))),
    1 / (2 * squared),
  );
  const up = scaled(normal, (normal[2] < 0 ? -1 : 1) / Math.sqrt(squared)); // whichever way round the rim was touched
  const aside = scaled(along, 1 / Math.hypot(...along));
  const height = shape.size[1];
  return {
    ...shape,
    size: [Math.hypot(...toCenter), height],
    orientation: quaternionOf(aside, cross(up, aside), up),
    position: sum(sum(first, toCenter), scaled(up, -height / 2)),
  };
}

/** The rotation to robot coordinates from axes that are given in them. @param {Vector} x @param {Vector} y @param {Vector} z @returns {Quaternion} */
function quaternionOf(x, y, z) {
  const trace = x[0] + y[1] + z[2];
  // The largest of w, x, y, z first: the others are divided by it.
  const squares = [trace, x[0] - y[1] - z[2], y[1] - x[0] - z[2], z[2] - x[0] - y[1]];
  const largest = squares.indexOf(Math.max(...squares));
  const twice = Math.sqrt(1 + squares[largest]);
  const [a, b, c] = [y[2] - z[1], z[0] - x[2], x[1] - y[0]];
  const [d, e, f] = [x[1] + y[0], x[2] + z[0], y[2] + z[1]];
  const half = twice / 2;
  const rest = /** @type {Quaternion[]} */ ([
    [half, a / twice / 2, b / twice / 2, c / twice / 2],
    [a / twice / 2, half, d / twice / 2, e / twice / 2],
    [b / twice / 2, d / twice / 2, half, f / twice / 2],
    [c / twice / 2, e / twice / 2, f / twice / 2, half],
  ]);
  return rest[largest];
}
