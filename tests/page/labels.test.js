// What the view writes at control points, and how wide the panel beside it may be.
import assert from "node:assert/strict";
import { test } from "node:test";
import { changeText } from "../../clients/web/editor/change_label.js";
import { numberedPoints } from "../../clients/web/editor/point_numbers.js";
import { allowedWidth } from "../../clients/web/panel_width.js";

test("a drag is said in millimetres, along the axes in which something moves", () => {
  assert.equal(changeText([0.0112, 0, 0]), "x +11\u202fmm");
  assert.equal(changeText([-0.0035, 0.0004, 1.25]), "x −4  z +1,250\u202fmm");
  assert.equal(changeText([0, 0, 0]), "");
});

test("few points have all their numbers, of many those that are selected", () => {
  assert.deepEqual(numberedPoints(3, [1]), [0, 1, 2]);
  assert.deepEqual(numberedPoints(100, [7, 9]), [7, 9]);
  assert.deepEqual(
    numberedPoints(
      100,
      Array.from({ length: 100 }, (_, k) => k),
    ),
    [],
  );
});

test("the panel is as wide as is wanted, while both it and the view have room", () => {
  assert.equal(allowedWidth(500.4, 1440), 500);
  assert.equal(allowedWidth(10, 1440), 320);
  assert.equal(allowedWidth(5000, 1440), 1080);
  assert.equal(allowedWidth(5000, 500), 320);
});
