// Colour along the curve: what was measured there, on a scale from just enough to plenty; red where the arm fails.
const STOPS = [[0.9, 0.6, 0.0], [0.55, 0.72, 0.4], [0.0, 0.45, 0.7]];
const FAILS = [0.78, 0.12, 0.1];

// What can be shown: its unit, and the values of the two ends of the scale.
export const MEASURES = {
  clearance: { title: "Clearance", unit: "mm", most: 60, of: (a) => a.clearance.map((m) => 1000 * m) },
  reach: { title: "Reach left", unit: "mm", most: 120, of: (a) => a.reach.map((m) => 1000 * m) },
  limits: { title: "Joint range left", unit: "°", most: 30, of: (a) => a.limits.map((rad) => (180 * rad) / Math.PI) },
};

// The colour of every parameter: (u, out) => void.
export function colouring(assessment, measure) {
  const { parameters, faults } = assessment;
  const values = measure.of(assessment);
  return (u, out) => {
    const i = before(parameters, u);
    const share = Math.min(1, Math.max(0, (u - parameters[i]) / (parameters[i + 1] - parameters[i] || 1)));
    const colour = faults[i] ? FAILS : onScale((values[i] + share * (values[i + 1] - values[i])) / measure.most);
    out.splice(0, 3, ...colour);
  };
}

function before(parameters, u) {
  let low = 0;
  let high = parameters.length - 1;
  while (high - low > 1) {
    const middle = (low + high) >> 1;
    if (u < parameters[middle]) high = middle;
    else low = middle;
  }
  return low;
}

function onScale(share) {
  const at = Math.min(1, Math.max(0, share)) * (STOPS.length - 1);
  const i = Math.min(STOPS.length - 2, Math.floor(at));
  return STOPS[i].map((value, k) => value + (at - i) * (STOPS[i + 1][k] - value));
}

export const css = (colour) => `rgb(${colour.map((value) => Math.round(255 * value)).join(" ")})`;
export const ends = { stops: STOPS.map(css), fails: css(FAILS) };
