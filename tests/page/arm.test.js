import assert from "node:assert/strict";
import { test } from "node:test";
import { linkFrames, toolPose } from "../../clients/web/arm/kinematics.js";
import { Motion } from "../../clients/web/arm/motion.js";
import { assertClose, fixture } from "./fixtures.js";

test("every link and any tool are where the service says, for every arm", () => {
  for (const { arm, q, frames, tool } of fixture("link_poses")) {
    assertClose(linkFrames(arm.joints, q), frames);
    assertClose(toolPose(arm, q), tool);
  }
});

test("a motion is interpolated between its samples, and holds its ends", () => {
  for (const { motion, samples } of fixture("motions")) {
    for (const { seconds, q, closed, position, orientation } of samples) {
      const sample = new Motion(motion).sample(seconds);
      assertClose(sample.q, q);
      assertClose(sample.position, position);
      assertClose(sample.orientation, orientation);
      assert.equal(sample.closed, closed);
    }
  }
});

test("a motion of which only the joints are known has no object, an open gripper and no words", () => {
  const motion = new Motion({ times: [5, 7], joints: [[0], [1]] });
  assert.deepEqual(motion.sample(1), { q: [0.5], closed: false, position: null, orientation: null, segment: "" });
  assert.equal(motion.duration, 2);
});
