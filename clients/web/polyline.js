// Polylines along a curve: sampling, arc length, slices.
import { evaluateCurve, linspace } from "./nurbs.js";

/**
 * `count` points at evenly spaced parameters.
 * @param {Curve} curve
 */
export function sampleCurve(curve, count = 161) {
  return evaluateCurve(curve, linspace(count));
}

/** @param {Point} a @param {Point} b */
export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

/**
 * Arc length from the first point to each [m].
 * @param {Point[]} points
 */
export function arcLengths(points) {
  let sum = 0;
  return points.map((point, i) => (sum += i ? distance(points[i - 1], point) : 0));
}

/**
 * The part of a polyline between two shares of its length.
 * @param {Point[]} points
 * @param {number[]} shares
 */
export function slicePolyline(points, [from, to]) {
  const along = arcLengths(points);
  const total = along.at(-1) || 1;
  const kept = points.filter((_, i) => along[i] >= from * total && along[i] <= to * total);
  return [pointAtLength(points, along, from * total), ...kept, pointAtLength(points, along, to * total)].filter(
    (p, i, all) => !i || distance(p, all[i - 1]) > 1e-6,
  );
}

/**
 * `count` points at equal arc length.
 * @param {Point[]} points
 * @param {number} count
 */
export function resamplePolyline(points, count) {
  const along = arcLengths(points);
  return Array.from({ length: count }, (_, i) => pointAtLength(points, along, (i / (count - 1)) * (along.at(-1) ?? 0)));
}

/** @param {Point[]} points @param {number[]} along arc lengths @param {number} length */
function pointAtLength(points, along, length) {
  let i = along.findIndex((value) => value >= length);
  if (i <= 0) i = i < 0 ? along.length - 1 : 1;
  const share = (length - along[i - 1]) / (along[i] - along[i - 1] || 1);
  return points[i - 1].map((value, axis) => value + Math.min(1, Math.max(0, share)) * (points[i][axis] - value));
}
