// What the page says of the arm's drives and gripper.
import assert from "node:assert/strict";
import { test } from "node:test";
import { driverTrouble, gripperText } from "../../clients/web/panels/driver_state.js";

const SOUND_STATE = {
  enabled: true,
  protective_stop: false,
  fault: "",
  gripper_closed: false,
  gripper_opening: 0.07,
  output: "",
};

test("an arm that follows has no trouble, and the gravest trouble is told first, with the way out", () => {
  assert.equal(driverTrouble(SOUND_STATE), "");
  assert.match(driverTrouble({ ...SOUND_STATE, enabled: false }), /drives are off.*Switch them on/);
  assert.match(driverTrouble({ ...SOUND_STATE, enabled: false, protective_stop: true }), /Protective stop.*release it/);
  const fault = { ...SOUND_STATE, enabled: false, protective_stop: true, fault: "brake 3" };
  assert.match(driverTrouble(fault), /fault: brake 3\. Clear it/);
});

test("a gripper tells what was asked of it and what is measured, and that nothing is", () => {
  assert.match(gripperText(SOUND_STATE), /^open, 70.mm measured$/);
  assert.match(gripperText({ ...SOUND_STATE, gripper_closed: true, gripper_opening: 0 }), /^closed, 0.mm measured$/);
  assert.equal(gripperText({ ...SOUND_STATE, gripper_opening: null }), "open, not measured");
});
