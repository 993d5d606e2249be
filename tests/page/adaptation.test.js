import assert from "node:assert/strict";
import { test } from "node:test";
import { predictPath } from "../../clients/web/editor/adaptation_model.js";
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
