// Sentences of the service count joints; the page calls them as the arm's model does.
import assert from "node:assert/strict";
import { test } from "node:test";
import { nameJoints, namePlace } from "../../clients/web/arm/joint_names.js";

const ROBOT = {
  variant: "ur5e",
  model: "0123456789abcdef",
  joints: ["shoulder_pan_joint", "shoulder_lift_joint"].map((name) => ({ name })),
};

test("joints are called by name, and stay counted where nobody knows the name", () => {
  const sentence = "joint 2 needs 190.0 deg, limit 180.0, and joint 1 is near; 3 joints 2 more, joint 7";
  const named =
    "shoulder_lift_joint needs 190.0 deg, limit 180.0, and shoulder_pan_joint is near; 3 joints 2 more, joint 7";
  assert.equal(nameJoints(sentence, ROBOT), named);
  assert.equal(nameJoints(sentence, null), sentence);
});

test("the certificate of another arm keeps its own count", () => {
  const place = "joint 1 at s = 0.412 m";
  /** @param {string | undefined} arm */
  const said = (arm) => namePlace(place, { signature: arm ? { arm } : null }, ROBOT);
  assert.equal(said("ur5e (0123456789ab)"), "shoulder_pan_joint at s = 0.412 m");
  for (const other of ["puma560", "ur5e (aaaaaaaaaaaa)", undefined]) assert.equal(said(other), place);
  assert.equal(namePlace(place, { signature: { arm: "puma560" } }, null), place);
});
