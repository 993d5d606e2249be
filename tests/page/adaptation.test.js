import assert from "node:assert/strict";
import { test } from "node:test";
import { predictPath } from "../../clients/web/editor/adaptation_model.js";
import { beyondShown, describeCertainty } from "../../clients/web/editor/adaptation_range.js";
import { assertClose, fixture } from "./fixtures.js";

test("a path between other ends is where the service predicts it, with its spread", () => {
  for (const { model, predictions } of fixture("adaptations")) {
    for (const { start, goal, path, deviation } of predictions) {
      const found = predictPath(model, start, goal);
      assertClose(found.points, path, 1e-9);
      assertClose(found.deviation, deviation, 1e-9);
      assert.deepEqual([found.points[0], found.points.at(-1)], [start, goal]);
    }
  }
});

test("between its own ends a version is itself", () => {
  for (const { model } of fixture("adaptations")) {
    assertClose(predictPath(model, model.version[0], model.version.at(-1)).points, model.version, 1e-9);
  }
});

test("what is beyond the shown range is told as the service tells it", () => {
  const begin = (/** @type {string} */ sentence) => sentence.split(" ").slice(0, 3).join(" ");
  const told = new Set();
  for (const { model, predictions } of fixture("adaptations")) {
    for (const { start, goal, extrapolates } of predictions) {
      assert.equal(begin(beyondShown(model, start, goal)), begin(extrapolates));
      told.add(begin(extrapolates));
    }
  }
  assert.deepEqual([...told].sort(), ["", "from start to", "start and goal", "the direction is", "the goal is"]);
});

test("how sure a path is, is said while it is dragged", () => {
  const [once, several] = fixture("adaptations");
  /** @param {{model: AdaptationModel, predictions: {start: Point, goal: Point, deviation: number[]}[]}} of @param {number} which */
  const said = ({ model, predictions }, which) => {
    const { start, goal, deviation } = predictions[which];
    return describeCertainty(model, start, goal, deviation);
  };
  assert.match(said(once, 1), /one place only/);
  assert.match(said(several, 1), /within \S+\smm of it, nineteen times of twenty/);
  assert.match(said(several, 3), /^Beyond what was shown: start and goal are \S+\smm apart/);
});
