import assert from "node:assert/strict";
import { test } from "node:test";
import { HandModel } from "../../clients/web/hand/hand_model.js";
import { encodeHandSample } from "../../clients/web/hand/hand_sample.js";
import { assertClose, fixture } from "./fixtures.js";

const TABLE = { name: "table", kind: "box", size: [1, 1, 0.1], position: [0, 0, 0.4] };
const PILLAR = { name: "pillar", kind: "cylinder", size: [0.05, 0.4], position: [0.3, 0, 0.65] };
const BOX = { kind: "box", size: [0.06, 0.06, 0.06], position: [0, 0, 0.5] };
const scene = { obstacles: [TABLE, PILLAR], carried: BOX };
const distance = (a, b) => Math.hypot(...a.map((value, i) => value - b[i]));

test("a sample is the bytes that protobuf writes", () => {
  for (const { sample, message } of fixture("hand_samples")) {
    assert.equal(Buffer.from(encodeHandSample(sample)).toString("hex"), message);
  }
});

test("a hand moves to its target, no faster than a hand, and stays there", () => {
  const hand = new HandModel(scene);
  hand.setTarget([0.4, -0.3, 0.9]);
  for (let i = 0; i < 200; i++) {
    const before = hand.position;
    hand.step(1 / 60);
    assert.ok(distance(before, hand.position) <= 1.2 / 60 + 1e-12);
  }
  assert.ok(distance(hand.position, [0.4, -0.3, 0.9]) < 1e-6);
  assert.equal(hand.step(1 / 60), false);
  hand.returnHome();
  for (let i = 0; i < 200; i++) hand.step(1 / 60);
  assert.ok(hand.isAtHome);
});

test("after a stall a hand makes no leap", () => {
  const hand = new HandModel(scene);
  hand.setTarget([1, 1, 1]);
  hand.step(10);
  assert.ok(distance(hand.position, BOX.position) <= 1.2 * 0.03 + 1e-12);
});

test("nothing is carried into the table, and beside it down to the floor", () => {
  const hand = new HandModel(scene);
  hand.setTarget([0.2, 0.2, 0]);
  assertClose([hand.target[2]], [0.45 + 0.03]);
  hand.setTarget([0.9, 0, 0]);
  assertClose([hand.target[2]], [0.03]);
});

test("an obstacle that the object is in is named", () => {
  const hand = new HandModel(scene);
  assert.equal(hand.collidingObstacle([0.3, 0, 0.6]), "pillar");
  assert.equal(hand.collidingObstacle([0.3, 0, 0.95]), "");
  assert.equal(hand.collidingObstacle([0.3, 0.2, 0.6]), "");
  assertClose([hand.heightBelow([0.3, 0, 1]), hand.heightBelow([0.1, 0, 1])], [0.85, 0.45]);
});
