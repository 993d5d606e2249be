import assert from "node:assert/strict";
import { test } from "node:test";
import { arcLengths, distance, resamplePolyline, slicePolyline } from "../../clients/web/polyline.js";
import { tubeIndices, writeTube } from "../../clients/web/tube_geometry.js";
import { assertClose } from "./fixtures.js";

const HELIX = Array.from({ length: 60 }, (_, i) => [Math.cos(i / 6), Math.sin(i / 6), i / 50]);
const CORNERS = [
  [0, 0, 0],
  [1, 0, 0],
  [1, 0, 0],
  [1, 1, 0],
  [1, 1, 2],
]; // two of them coincide

function tube(points, radius) {
  const size = 3 * (Math.max(...tubeIndices(points.length)) + 1);
  const [positions, normals] = [new Float64Array(size), new Float64Array(size)];
  writeTube(points.flat(), radius, positions, normals);
  const sides = size / 3 / points.length;
  const vertex = (array, i, k) => [...array.subarray(3 * (i * sides + k), 3 * (i * sides + k) + 3)];
  return { sides, position: (i, k) => vertex(positions, i, k), normal: (i, k) => vertex(normals, i, k) };
}

const dot = (a, b) => a.reduce((sum, value, i) => sum + value * b[i], 0);
const minus = (a, b) => a.map((value, i) => value - b[i]);

test("every vertex of a tube is its radius away from its point, along a unit normal", () => {
  for (const points of [HELIX, CORNERS]) {
    const radii = points.map((_, i) => 0.01 + 0.001 * i);
    const { sides, position, normal } = tube(points, radii);
    points.forEach((point, i) => {
      for (let k = 0; k < sides; k++) {
        assertClose([distance(position(i, k), point), Math.hypot(...normal(i, k))], [radii[i], 1], 1e-9);
      }
    });
  }
});

test("the rings stand across the polyline and do not twist", () => {
  const { normal } = tube(HELIX, 0.01);
  for (let i = 1; i + 1 < HELIX.length; i++) {
    const tangent = minus(HELIX[i + 1], HELIX[i - 1]);
    assert.ok(Math.abs(dot(normal(i, 0), tangent)) < 1e-9);
    assert.ok(dot(normal(i, 0), normal(i - 1, 0)) > Math.cos(0.2)); // the tangent itself turns by 1/6
  }
});

test("the triangles of a tube join neighbouring rings only", () => {
  const { sides } = tube(HELIX, 1);
  const indices = tubeIndices(HELIX.length);
  assert.equal(indices.length, 6 * sides * (HELIX.length - 1));
  for (let i = 0; i < indices.length; i += 3) {
    const rings = indices.slice(i, i + 3).map((index) => Math.floor(index / sides));
    assert.equal(Math.max(...rings) - Math.min(...rings), 1);
  }
});

test("resampled points are equally far from each other along the polyline and keep its ends", () => {
  const line = [
    [0, 0, 0],
    [0.1, 0, 0],
    [3, 0, 0],
  ];
  assertClose(resamplePolyline(line, 4), [
    [0, 0, 0],
    [1, 0, 0],
    [2, 0, 0],
    [3, 0, 0],
  ]);
});

test("a slice is as long as its share, and begins and ends where that does", () => {
  const whole = arcLengths(HELIX).at(-1);
  const slice = slicePolyline(HELIX, [0.2, 0.7]);
  assertClose([arcLengths(slice).at(-1)], [0.5 * whole], 1e-9);
  assertClose(slicePolyline(HELIX, [0, 1]), HELIX, 1e-9);
});
