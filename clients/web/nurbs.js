// A clamped NURBS {degree, knots, control_points, weights}, evaluated as the service does (service/teachpath/nurbs.py).
// Piegl & Tiller, The NURBS Book: algorithms A2.1 (span), A2.2 (basis functions), eq. (4.1).

/** @typedef {Pick<Curve, "degree" | "knots">} Spline */

/** The basis functions at parameters u: computed once, as long as degree and knots stay. */
export class BasisFunctions {
  /** @param {number} degree @param {number[]} knots @param {number[]} u */
  constructor(degree, knots, u) {
    this.degree = degree;
    this.knots = knots;
    this.count = u.length;
    this.first = new Int32Array(u.length); // the first control point that counts at each parameter
    this.values = new Float64Array(u.length * (degree + 1));
    for (const [i, at] of u.entries()) {
      const span = findSpan(degree, knots, at);
      this.first[i] = span - degree;
      this.values.set(basisValues(degree, knots, span, at), i * (degree + 1));
    }
  }

  /** @param {Spline} curve */
  matches({ degree, knots }) {
    return (
      degree === this.degree && knots.length === this.knots.length && knots.every((knot, i) => knot === this.knots[i])
    );
  }

  /**
   * Points of a curve of these knots: x, y, z after x, y, z, written into `out` [m].
   * @param {Pick<Curve, "control_points" | "weights">} curve
   * @param {Float64Array} out
   */
  evaluate({ control_points, weights }, out = new Float64Array(3 * this.count)) {
    const order = this.degree + 1;
    for (let i = 0; i < this.count; i++) {
      let x = 0,
        y = 0,
        z = 0,
        w = 0;
      for (let j = 0; j < order; j++) {
        const k = this.first[i] + j;
        const share = this.values[i * order + j] * weights[k];
        const point = control_points[k];
        x += share * point[0];
        y += share * point[1];
        z += share * point[2];
        w += share;
      }
      out[3 * i] = x / w;
      out[3 * i + 1] = y / w;
      out[3 * i + 2] = z / w;
    }
    return out;
  }
}

/**
 * Points of a curve at parameters u.
 * @param {Curve} curve
 * @param {number[]} u
 * @returns {Point[]}
 */
export function evaluateCurve(curve, u) {
  const flat = new BasisFunctions(curve.degree, curve.knots, u).evaluate(curve);
  return u.map((_, i) => [...flat.subarray(3 * i, 3 * i + 3)]);
}

/**
 * Evenly spaced parameters from 0 to 1.
 * @param {number} count
 */
export const linspace = (count) => Array.from({ length: count }, (_, i) => i / (count - 1));

/**
 * The knot span [knots[span], knots[span + 1]) of a parameter; the last one holds its end.
 * @param {number} degree
 * @param {number[]} knots
 * @param {number} u
 */
export function findSpan(degree, knots, u) {
  let low = degree;
  let high = knots.length - degree - 1;
  if (u >= knots[high]) {
    while (knots[high - 1] === knots[high]) high -= 1;
    return high - 1;
  }
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (u < knots[middle]) high = middle;
    else low = middle;
  }
  return low;
}

/** @param {number} degree @param {number[]} knots @param {number} span @param {number} u */
function basisValues(degree, knots, span, u) {
  const values = new Float64Array(degree + 1);
  const left = new Float64Array(degree + 1);
  const right = new Float64Array(degree + 1);
  values[0] = 1;
  for (let j = 1; j <= degree; j++) {
    left[j] = u - knots[span + 1 - j];
    right[j] = knots[span + j] - u;
    let saved = 0;
    for (let r = 0; r < j; r++) {
      const share = values[r] / (right[r + 1] + left[j - r]);
      values[r] = saved + right[r + 1] * share;
      saved = left[j - r] * share;
    }
    values[j] = saved;
  }
  return values;
}
