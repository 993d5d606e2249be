// A clamped NURBS, as the service evaluates it (service/teachpath/nurbs.py), and what is measured along its points.

// The point at parameter u in [0, 1]: de Boor's algorithm on homogeneous control points (The NURBS Book, ch. 4).
export function pointAt({ degree, knots, control_points: points, weights }, u) {
  const last = points.length - 1;
  let span = degree;
  while (span < last && u >= knots[span + 1]) span += 1;
  const rows = [];
  for (let j = 0; j <= degree; j++) {
    const i = span - degree + j;
    rows.push([...points[i].map((value) => value * weights[i]), weights[i]]);
  }
  for (let level = 1; level <= degree; level++) {
    for (let j = degree; j >= level; j--) {
      const i = span - degree + j;
      const share = (u - knots[i]) / (knots[i + degree - level + 1] - knots[i]);
      rows[j] = rows[j].map((value, axis) => (1 - share) * rows[j - 1][axis] + share * value);
    }
  }
  const top = rows[degree];
  const weight = top.at(-1);
  return top.slice(0, -1).map((value) => value / weight);
}

// `count` points at even parameters.
export function sampled(curve, count = 161) {
  return Array.from({ length: count }, (_, i) => pointAt(curve, i / (count - 1)));
}

export const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);

// Arc length from the first point to each [m].
export function lengths(points) {
  let sum = 0;
  return points.map((point, i) => (sum += i ? distance(points[i - 1], point) : 0));
}

// The stretch of a polyline between two shares of its length.
export function stretch(points, [from, to]) {
  const along = lengths(points);
  const total = along.at(-1) || 1;
  const kept = points.filter((_, i) => along[i] >= from * total && along[i] <= to * total);
  return [at(points, along, from * total), ...kept, at(points, along, to * total)].filter((p, i, all) => !i || distance(p, all[i - 1]) > 1e-6);
}

// `count` points at equal arc length.
export function even(points, count) {
  const along = lengths(points);
  return Array.from({ length: count }, (_, i) => at(points, along, (i / (count - 1)) * along.at(-1)));
}

function at(points, along, length) {
  let i = along.findIndex((value) => value >= length);
  if (i <= 0) i = i < 0 ? along.length - 1 : 1;
  const share = (length - along[i - 1]) / (along[i] - along[i - 1] || 1);
  return points[i - 1].map((value, axis) => value + Math.min(1, Math.max(0, share)) * (points[i][axis] - value));
}
