// Colour along the curve: what was measured there, on a scale from just enough to plenty; red where the arm fails.
const COLOR_STOPS = [
  [0.9, 0.6, 0.0],
  [0.55, 0.72, 0.4],
  [0.0, 0.45, 0.7],
];
const FAILURE_COLOR = [0.78, 0.12, 0.1];

/**
 * What can be shown: its unit, the value at the end of the scale, and the values of an assessment.
 * @typedef {{title: string, unit: string, max: number, of: (assessment: Assessment) => number[]}} Metric
 */

/** @type {Record<string, Metric>} */
export const METRICS = {
  clearance: { title: "Clearance", unit: "mm", max: 60, of: (a) => a.clearance.map((m) => 1000 * m) },
  reach: { title: "Reach left", unit: "mm", max: 120, of: (a) => a.reach.map((m) => 1000 * m) },
  limits: { title: "Joint range left", unit: "°", max: 30, of: (a) => a.limits.map((rad) => (180 * rad) / Math.PI) },
};

/**
 * What writes the colour of every parameter.
 * @param {Assessment} assessment
 * @param {Metric} metric
 */
export function colorFunction(assessment, metric) {
  const { parameters, faults } = assessment;
  const values = metric.of(assessment);
  /** @param {number} u @param {number[]} out */
  return (u, out) => {
    const i = findInterval(parameters, u);
    const share = Math.min(1, Math.max(0, (u - parameters[i]) / (parameters[i + 1] - parameters[i] || 1)));
    const color = faults[i]
      ? FAILURE_COLOR
      : scaleColor((values[i] + share * (values[i + 1] - values[i])) / metric.max);
    out.splice(0, 3, ...color);
  };
}

/** @param {number[]} parameters @param {number} u */
function findInterval(parameters, u) {
  let low = 0;
  let high = parameters.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (u < parameters[middle]) high = middle;
    else low = middle;
  }
  return low;
}

/** @param {number} share */
function scaleColor(share) {
  const at = Math.min(1, Math.max(0, share)) * (COLOR_STOPS.length - 1);
  const i = Math.min(COLOR_STOPS.length - 2, Math.floor(at));
  return COLOR_STOPS[i].map((value, k) => value + (at - i) * (COLOR_STOPS[i + 1][k] - value));
}

/** @param {number[]} color red, green, blue, 0 to 1 */
export const css = (color) => `rgb(${color.map((value) => Math.round(255 * value)).join(" ")})`;
export const legendColors = { stops: COLOR_STOPS.map(css), fails: css(FAILURE_COLOR) };
