import assert from "node:assert/strict";
import { test } from "node:test";
import { grevilleAbscissa, innerKnots, movePoints, spanMidpoint } from "../../clients/web/editor/curve_edits.js";
import { BasisFunctions, evaluateCurve, findSpan, linspace } from "../../clients/web/nurbs.js";
import { assertClose, fixture } from "./fixtures.js";

const curves = fixture("curves");

test("a curve is where the service says, at any degree and multiplicity of its knots", () => {
  for (const curve of curves) assertClose(evaluateCurve(curve, curve.parameters), curve.points);
});

test("the basis functions are a partition of unity that no control point changes", () => {
  for (const curve of curves) {
    const basis = new BasisFunctions(curve.degree, curve.knots, linspace(33));
    const ones = curve.control_points.map(() => [1, 1, 1]);
    assertClose(basis.evaluate({ ...curve, control_points: ones }), Array(99).fill(1));
    assert.ok(basis.matches(curve));
    assert.ok(!basis.matches({ ...curve, knots: curve.knots.map((knot) => knot / 2) }));
  }
});

test("a span holds its parameter, the last one the end", () => {
  for (const { degree, knots } of curves) {
    for (const u of linspace(41)) {
      const span = findSpan(degree, knots, u);
      assert.ok(knots[span] <= u && (u < knots[span + 1] || (u === 1 && knots[span + 1] === 1)));
      assert.ok(knots[span] < knots[span + 1]);
      const middle = spanMidpoint({ degree, knots }, u);
      assert.ok(knots[span] < middle && middle < knots[span + 1]);
    }
  }
});

test("the Greville abscissa of a control point is the mean of its inner knots", () => {
  for (const curve of curves)
    assertClose(
      curve.control_points.map((_, i) => grevilleAbscissa(curve, i)),
      curve.greville,
    );
});

test("inner knots are counted with their multiplicity", () => {
  const inner = curves.map((curve) => innerKnots(curve).map(({ u, times }) => Array(times).fill(u))).flat(2);
  assert.deepEqual(
    inner,
    curves.flatMap(({ knots, degree }) => knots.slice(degree + 1, -degree - 1)),
  );
});

test("moving all control points moves the curve as far, and leaves the given one as it was", () => {
  const [curve] = curves;
  const before = structuredClone(curve);
  const moved = movePoints(curve, [...curve.control_points.keys()], [1, -2, 3]);
  assertClose(
    evaluateCurve(moved, curve.parameters),
    curve.points.map(([x, y, z]) => [x + 1, y - 2, z + 3]),
  );
  assert.deepEqual(curve, before);
});
