// Scenes as they are edited: shapes, names, steps of undo, and orientations in degrees.
import assert from "node:assert/strict";
import { test } from "node:test";
import {
  copyOf,
  freeName,
  meshExtent,
  namesIn,
  newMesh,
  newShape,
  SceneDraft,
  SHAPE_ROLES,
  sceneBody,
  shapeAt,
  shapesOf,
  withNewShape,
  withoutShape,
  withShape,
} from "../../clients/web/scenes/scene_draft.js";
import { orientationOf, turnsOf } from "../../clients/web/scenes/turns.js";

const TABLE = {
  name: "table",
  kind: "box",
  size: [0.9, 1.2, 0.04],
  position: [0.6, 0, 0.48],
  orientation: [1, 0, 0, 0],
};
const SCENE = {
  name: "cell",
  display_name: "Cell 3",
  obstacles: [TABLE],
  carried: null,
  floor: 0,
  keep_in: [],
  keep_out: [],
};
const VERSION = { scene: "cell", number: 3 };

test("what is new lies on the table, has a name of its own, and is there alone", () => {
  for (const part of SHAPE_ROLES) {
    const kind = part === "keep_in" ? "box" : "cylinder";
    const shape = newShape(SCENE, part, kind);
    const { scene, place } = withNewShape(SCENE, part, shape);
    assert.equal(shapeAt(scene, place), shape);
    assert.equal(shapesOf(scene, part).length, shapesOf(SCENE, part).length + 1);
    const half = shape.size.at(-1) / 2;
    assert.equal(shape.size.length, kind === "box" ? 3 : 2);
    const ground = part === "keep_in" ? 0 : 0.5;
    assert.ok(Math.abs(shape.position[2] - half - ground) < 1e-12, part);
    assert.deepEqual(withoutShape(scene, place), SCENE);
    assert.deepEqual(SCENE.obstacles, [TABLE]); // the former scene is as it was
  }
  assert.equal(newShape({ ...SCENE, obstacles: [] }, "obstacles", "sphere").position[2], 0.05); // on the floor
});

test("a mesh stands on the table, in millimetres where it would be larger than a room", () => {
  const corners = (size) => [0, size].flatMap((x) => [0, size].flatMap((y) => [0, size].map((z) => [x, y, z - size])));
  for (const [size, unit] of [
    [40, 0.001],
    [0.04, 1],
  ]) {
    const shape = newMesh(SCENE, "carried", { file: "Part A (2).final.stl", vertices: corners(size) });
    assert.deepEqual([shape.name, shape.kind, shape.size], ["Part-A-2-final", "mesh", [unit]]);
    for (const extent of meshExtent(shape)) assert.ok(Math.abs(extent - 0.04) < 1e-12);
    const off = shape.position.map((value, k) => Math.abs(value - [0.58, -0.02, 0.54][k]));
    assert.ok(Math.max(...off) < 1e-12);
  }
  assert.equal(newMesh(SCENE, "obstacles", { file: "(1).stl", vertices: corners(1) }).name, "1");
  assert.equal(newMesh(SCENE, "obstacles", { file: ".stl", vertices: corners(1) }).name, "mesh");
});

test("another object takes the place of the one that is there", () => {
  const first = withNewShape(SCENE, "carried", newShape(SCENE, "carried", "box")).scene;
  const second = withNewShape(first, "carried", newShape(first, "carried", "cylinder"));
  assert.equal(second.scene.carried.kind, "cylinder");
  assert.deepEqual(second.place, { part: "carried", index: 0 });
});

test("no two shapes of a scene have one name, in whichever part they are", () => {
  let scene = SCENE;
  for (let k = 0; k < 3; k += 1) scene = withNewShape(scene, "keep_out", copyOf(scene, TABLE)).scene;
  assert.deepEqual(namesIn(scene), ["table", "table-2", "table-3", "table-4"]);
  assert.equal(freeName(scene, "table-2"), "table-5");
  assert.equal(freeName(scene, "shelf"), "shelf");
});

test("each step is undone and done again, and what is as it was saved is not edited", () => {
  const draft = new SceneDraft({ version: VERSION, scene: SCENE });
  const moved = withShape(SCENE, { part: "obstacles", index: 0 }, { ...TABLE, position: [0.5, 0, 0.48] });
  draft.change({ ...SCENE }, "nothing");
  assert.deepEqual([draft.isEdited, draft.undoLabel], [false, ""]);
  draft.change(moved, "moving table");
  assert.deepEqual([draft.isEdited, draft.undoLabel, draft.redoLabel], [true, "moving table", ""]);
  draft.undo();
  assert.deepEqual([draft.scene, draft.isEdited, draft.redoLabel], [SCENE, false, "moving table"]);
  draft.redo();
  assert.equal(draft.scene, moved);
  draft.saved(4, moved);
  assert.deepEqual([draft.base, draft.isEdited], [4, false]);
  draft.undo();
  assert.equal(draft.isEdited, true); // beside what was saved
});

test("who takes a version that was saved meanwhile goes on from it, and undoes that with the version of before", () => {
  const draft = new SceneDraft({ version: VERSION, scene: SCENE });
  const [mine, theirs] = [0.1, 0.2].map((floor) => ({ ...SCENE, floor }));
  draft.change(mine, "mine");
  draft.rebase({ base: 4, original: theirs }, "taking version 4");
  assert.deepEqual([draft.base, draft.scene, draft.isEdited], [4, theirs, false]);
  draft.undo();
  assert.deepEqual([draft.base, draft.scene, draft.isEdited], [3, mine, true]); // so that saving it is refused as before
  draft.redo();
  assert.deepEqual([draft.base, draft.scene, draft.isEdited], [4, theirs, false]);
});

test("what is saved is all of the scene but its name", () => {
  const { name, ...rest } = SCENE;
  assert.deepEqual(sceneBody(SCENE, { base: 3, author: "Ada", note: "" }), {
    ...rest,
    base: 3,
    author: "Ada",
    note: "",
  });
});

test("degrees about x, y and z are those of the orientation, also where two axes turn alike", () => {
  for (const turns of [
    [0, 0, 0],
    [90, 0, 0],
    [0, 0, -135],
    [10, -20, 170],
    [-179, 89, 1],
    [30, 90, 0],
    [0, -90, 50],
  ]) {
    const orientation = orientationOf(turns);
    assert.ok(Math.abs(Math.hypot(...orientation) - 1) < 1e-12);
    const again = orientationOf(turnsOf(orientation));
    const same = Math.abs(again.reduce((sum, value, k) => sum + value * orientation[k], 0)); // q and -q are one orientation
    assert.ok(same > 1 - 1e-9, `${turns}`);
  }
  const [w, x, y, z] = orientationOf([0, 0, 90]);
  assert.ok(Math.abs(w - z) < 1e-12 && x === 0 && y === 0); // about z alone
});
