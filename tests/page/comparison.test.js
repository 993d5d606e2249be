// Two demonstrations over time, and the samples that a trim keeps.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  compareMotions,
  overShare,
  positionAt,
  trimmedSamples,
} from "../../clients/web/panels/demonstration_comparison.js";

const straight = (/** @type {number} */ seconds, /** @type {number} */ height) => ({
  times: [0, seconds / 4, seconds],
  positions: [
    [0, 0, height],
    [0.1, 0, height],
    [0.4, 0, height],
  ],
});

test("between two samples a motion is in between, and before and after it nowhere", () => {
  const motion = straight(4, 0.5);
  assert.deepEqual(positionAt(motion, 1), [0.1, 0, 0.5]);
  const between = positionAt(motion, 2) ?? [];
  for (const [axis, value] of [0.2, 0, 0.5].entries()) assert.ok(Math.abs(between[axis] - value) < 1e-12);
  assert.equal(positionAt(motion, 4.001), null);
  assert.equal(positionAt({ times: [], positions: [] }, 0), null);
});

test("equal motions of other speeds are apart over seconds, and together over the share of their time", () => {
  const [slow, fast] = [straight(8, 0.5), straight(4, 0.5)];
  const seconds = compareMotions(slow, fast);
  assert.equal(seconds.times.at(-1), 8);
  assert.ok(seconds.distances.at(-1) === null && seconds.largest > 0.1);
  const share = compareMotions(overShare(slow), overShare(fast));
  assert.equal(share.times.at(-1), 100);
  assert.ok(share.largest < 1e-12);
});

test("motions one above the other are apart by their height at all times", () => {
  const found = compareMotions(straight(4, 0.5), straight(4, 0.7));
  assert.ok(Math.abs(found.mean - 0.2) < 1e-12 && Math.abs(found.largest - 0.2) < 1e-12);
});

test("a trim keeps the samples between its marks, of what is kept already", () => {
  const times = Array.from({ length: 101 }, (_, k) => k * 0.02);
  const demonstration = { trim: null, grasp: 40, release: 141 };
  assert.deepEqual(trimmedSamples(demonstration, times, { grasp: 0, release: 2 }), [40, 141]);
  assert.deepEqual(trimmedSamples(demonstration, times, { grasp: 0.2, release: 1.801 }), [50, 131]);
  const trimmed = { ...demonstration, trim: /** @type {[number, number]} */ ([50, 151]) };
  assert.deepEqual(trimmedSamples(trimmed, times, { grasp: 0.02, release: 2 }), [51, 151]);
  const thinned = times.filter((_, k) => k % 10 === 0);
  assert.deepEqual(trimmedSamples(demonstration, thinned, { grasp: 0.2, release: 1.8 }), [50, 131]);
});
