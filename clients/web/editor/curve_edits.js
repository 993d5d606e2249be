// The edited curve as a plain value {degree, knots, control_points, weights}; it is never changed in place.
import { findSpan } from "../nurbs.js";

/** @param {Curve} a @param {Curve} b */
export function curvesEqual(a, b) {
  return (
    JSON.stringify([a.degree, a.knots, a.control_points, a.weights]) ===
    JSON.stringify([b.degree, b.knots, b.control_points, b.weights])
  );
}

/**
 * The curve with some control points moved.
 * @param {Curve} curve
 * @param {number[]} indices
 * @param {number[]} by [m]
 * @returns {Curve}
 */
export function movePoints(curve, indices, by) {
  const chosen = new Set(indices);
  return {
    ...curve,
    control_points: curve.control_points.map((p, i) => (chosen.has(i) ? p.map((value, axis) => value + by[axis]) : p)),
  };
}

/** @param {Curve} curve @param {number} index @param {Point} point @returns {Curve} */
export function setPoint(curve, index, point) {
  return { ...curve, control_points: curve.control_points.map((p, i) => (i === index ? point : p)) };
}

/** @param {Curve} curve @param {number[]} indices @param {number} weight @returns {Curve} */
export function setWeights(curve, indices, weight) {
  const chosen = new Set(indices);
  return { ...curve, weights: curve.weights.map((w, i) => (chosen.has(i) ? weight : w)) };
}

/** @typedef {import("../nurbs.js").Spline} Spline */

/**
 * The parameter around which a control point pulls most: its Greville abscissa.
 * @param {Spline} curve
 * @param {number} index
 */
export function grevilleAbscissa({ degree, knots }, index) {
  let sum = 0;
  for (let i = 1; i <= degree; i++) sum += knots[index + i];
  return sum / degree;
}

/**
 * Inner knots with how often each is there.
 * @param {Spline} curve
 */
export function innerKnots({ degree, knots }) {
  /** @type {{u: number, times: number}[]} */
  const inner = [];
  for (const u of knots.slice(degree + 1, -degree - 1)) {
    const last = inner.at(-1);
    if (last?.u === u) last.times += 1;
    else inner.push({ u, times: 1 });
  }
  return inner;
}

/**
 * Where a new knot helps most near a parameter: the middle of its span.
 * @param {Spline} curve
 * @param {number} u
 */
export function spanMidpoint({ degree, knots }, u) {
  const span = findSpan(degree, knots, u);
  return (knots[span] + knots[span + 1]) / 2;
}
