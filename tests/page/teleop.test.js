import assert from "node:assert/strict";
import { test } from "node:test";
import { teleopText } from "../../clients/web/panels/teleop_elements.js";

const session = { usesPageHand: true, usesHeadset: false };
const followed = { hand: "glove", hand_scene: "paper", hindrance: "", awaits_clutch: false };
const status = (changes) => ({ state: "held", reason: "", ...followed, ...changes });

test("what hinders an arm that follows a hand is said while it follows", () => {
  const slow = "finger is near to table, so every step is checked first and the tool is slow";
  assert.equal(
    teleopText(status({ state: "following", hindrance: slow }), session),
    "The arm follows in scene paper. Finger is near to table, so every step is checked first and the tool is slow.",
  );
  assert.equal(teleopText(status({ state: "following" }), session), "The arm follows in scene paper.");
});

test("an arm that is held says why, and how it is led while it only waits for the clutch", () => {
  assert.equal(
    teleopText(status({ reason: "the hand was lost; the arm goes on by itself if that ends within 1 s" }), session),
    "The arm is held: the hand was lost; the arm goes on by itself if that ends within 1 s.",
  );
  const waits = status({ reason: "press the clutch (button bit 2) to move the arm", awaits_clutch: true });
  assert.match(teleopText(waits, session), /^The arm is held in scene paper\. Press on the ball/);
  assert.match(
    teleopText(waits, { ...session, usesPageHand: false }),
    /^The arm is held in scene paper\. Hold the clutch/,
  );
  assert.match(
    teleopText(waits, { ...session, usesHeadset: true }),
    /^The arm is held in scene paper\. Close the left hand/,
  );
});
