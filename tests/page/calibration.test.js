// Where touched places put things: laws of rotations, a scene that moves as one, shapes that go through the touched points.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  distance,
  mapped,
  movedScene,
  placedByTouch,
  product,
  rotated,
  topCorners,
} from "../../clients/web/calibration/placement.js";
import { orientationOf } from "../../clients/web/scenes/turns.js";

const BOX = {
  name: "table",
  kind: "box",
  size: [0.9, 1.2, 0.04],
  position: [0.6, 0.1, 0.48],
  orientation: orientationOf([5, -10, 30]),
};
const ROD = { name: "rod", kind: "cylinder", size: [0.05, 0.3], position: [0.4, 0, 0.5], orientation: [1, 0, 0, 0] };
const SCENE = { name: "cell", obstacles: [BOX], carried: ROD, floor: 0, keep_in: [], keep_out: [] };
const MOTION = { name: "", scale: 1, rotation: orientationOf([20, 40, -70]), offset: [0.1, -0.2, 0.3] };

/** @param {number[]} a @param {number[]} b */
const near = (a, b) => assert.ok(distance(a, b) < 1e-9, `${a} is not ${b}`);
/** Quaternions of either sign are one rotation. @param {number[]} a @param {number[]} b */
const sameTurn = (a, b) => assert.ok(Math.abs(a.reduce((sum, value, k) => sum + value * b[k], 0)) > 1 - 1e-9);

test("one rotation after the other is their product", () => {
  const [a, b, v] = [MOTION.rotation, BOX.orientation, [0.3, -0.4, 0.5]];
  near(rotated(product(a, b), v), rotated(a, rotated(b, v)));
  assert.ok(Math.abs(Math.hypot(...rotated(a, v)) - Math.hypot(...v)) < 1e-12);
});

test("a moved scene keeps all distances, and its corners go where the motion puts them", () => {
  const moved = movedScene(SCENE, MOTION);
  const corners = topCorners(BOX);
  topCorners(moved.obstacles[0]).forEach((corner, k) => {
    near(corner, mapped(MOTION, corners[k]));
  });
  near(moved.carried.position, mapped(MOTION, ROD.position));
  assert.equal(moved.floor, 0);
  assert.deepEqual(SCENE.obstacles, [BOX]); // the former scene is as it was
});

test("a box is where three points of its top are touched, however it lay before", () => {
  for (const turns of [
    [0, 0, 0],
    [5, -10, 30],
    [0, 0, 179],
    [170, 20, 60],
    [10, 175, -100],
  ]) {
    const there = { ...BOX, orientation: orientationOf(turns) };
    const [first, second, third] = topCorners(there);
    const elsewhere = { ...BOX, position: [0, 0, 0], orientation: [1, 0, 0, 0] };
    const placed = placedByTouch(elsewhere, [first, second, third]);
    near(placed.position, there.position);
    sameTurn(placed.orientation, there.orientation);
    assert.equal(placed.size, elsewhere.size);
  }
});

test("a cylinder stands under the rim that was touched either way round, as wide as that", () => {
  const rim = [10, 130, 200].map((degrees) => {
    const angle = (degrees * Math.PI) / 180;
    return mapped(MOTION, [0.07 * Math.cos(angle), 0.07 * Math.sin(angle), 0.15]);
  });
  const isUp = rotated(MOTION.rotation, [0, 0, 1])[2] > 0;
  assert.ok(isUp);
  for (const points of [rim, [...rim].reverse()]) {
    const placed = placedByTouch(ROD, points);
    near(placed.position, MOTION.offset);
    near(rotated(placed.orientation, [0, 0, 1]), rotated(MOTION.rotation, [0, 0, 1]));
    assert.ok(Math.abs(placed.size[0] - 0.07) < 1e-9);
    assert.equal(placed.size[1], 0.3);
  }
});

test("points on one line, or one point twice, place nothing", () => {
  const [a, b] = topCorners(BOX);
  for (const points of [
    [a, b, a.map((value, k) => (value + b[k]) / 2)],
    [a, a, b],
  ])
    assert.throws(() => placedByTouch(BOX, points), /touch them again, farther apart/);
});
