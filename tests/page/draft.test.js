import assert from "node:assert/strict";
import { test } from "node:test";
import { curvesEqual, movePoints, setWeights } from "../../clients/web/editor/curve_edits.js";
import { Draft } from "../../clients/web/editor/draft.js";
import { fixture } from "./fixtures.js";

const BASE = { number: 1, branch: "main" };
const original = fixture("curves").find(({ control_points }) => control_points.length > 4);
const moved = (by) => movePoints(original, [1], [by, 0, 0]);

// The browser's storage of a tab, in memory.
class MemoryStorage {
  #texts = new Map();

  getItem(key) {
    return this.#texts.get(key) ?? null;
  }

  setItem(key, text) {
    this.#texts.set(key, text);
  }
}

const draft = (storage = new MemoryStorage()) => new Draft("path-1", BASE, original, storage);

test("undo and redo go through every step and name it", () => {
  const edited = draft();
  edited.change(moved(1), "first");
  edited.change(moved(2), "second");
  assert.equal(edited.undoLabel, "second");
  edited.undo();
  assert.ok(curvesEqual(edited.curve, moved(1)));
  assert.equal(edited.redoLabel, "second");
  edited.undo();
  assert.ok(!edited.edited);
  assert.equal(edited.undoLabel, "");
  edited.undo();
  edited.redo();
  edited.redo();
  edited.redo();
  assert.ok(curvesEqual(edited.curve, moved(2)));
});

test("a new step ends what could be redone, and no step is none", () => {
  const edited = draft();
  edited.change(moved(1), "first");
  edited.undo();
  edited.change(original, "nothing");
  assert.equal(edited.redoLabel, "first");
  edited.change(moved(2), "second");
  assert.equal(edited.redoLabel, "");
});

test("a drag is one step, however many curves it goes through, and a cancelled one is none", () => {
  const edited = draft();
  edited.beginDrag();
  for (const by of [1, 2, 3]) edited.preview(moved(by));
  edited.endDrag("drag");
  edited.beginDrag();
  edited.preview(moved(4));
  edited.cancelDrag();
  assert.ok(curvesEqual(edited.curve, moved(3)));
  edited.undo();
  assert.ok(!edited.edited);
});

test("start and goal are pinned until they are unlocked", () => {
  const edited = draft();
  edited.select([0, 2, edited.last, 2, -1, 99]);
  assert.deepEqual(edited.selected, [0, 2, edited.last]);
  assert.deepEqual(edited.movable, [2]);
  edited.unlocked = true;
  assert.deepEqual(edited.movable, edited.selected);
});

test("a draft survives a reload with its steps, and one path's draft is not another's", () => {
  const storage = new MemoryStorage();
  const edited = draft(storage);
  edited.change(moved(1), "first");
  edited.change(setWeights(edited.curve, [2], 3), "second");
  edited.undo();
  const restored = Draft.restore("path-1", storage);
  assert.ok(curvesEqual(restored.curve, moved(1)));
  assert.deepEqual([restored.undoLabel, restored.redoLabel, restored.base], ["first", "second", BASE]);
  assert.equal(Draft.restore("path-2", storage), null);
});

test("a long history is cut where the storage would be full; the curve is not", () => {
  const storage = new MemoryStorage();
  const edited = draft(storage);
  for (let i = 1; i <= 40; i++) edited.change(moved(i), `${"long ".repeat(20_000)}${i}`);
  const restored = Draft.restore("path-1", storage);
  assert.ok(curvesEqual(restored.curve, moved(40)));
  assert.equal(restored.undoLabel, edited.undoLabel);
  assert.ok(storage.getItem("teachpath.draft/path-1").length <= 1_500_000);
});

test("saving makes the curve the version's, and going on from another version can be undone", () => {
  const edited = draft();
  edited.change(moved(1), "first");
  const saving = edited.curve;
  edited.change(moved(2), "while it is saved");
  edited.saved({ number: 2, branch: "main" }, saving);
  assert.ok(edited.edited);
  edited.undo();
  assert.ok(!edited.edited);
  edited.rebase(BASE, original, "back");
  assert.ok(!edited.edited);
  edited.undo();
  assert.ok(curvesEqual(edited.curve, moved(1)));
});

test("undo after another version was taken goes back to the version that mine was made from", () => {
  const edited = draft();
  edited.change(moved(1), "mine");
  edited.rebase({ number: 2, branch: "main" }, moved(2), "theirs");
  edited.undo();
  assert.deepEqual(edited.base, BASE); // so that saving it asks again
  assert.ok(curvesEqual(edited.curve, moved(1)) && edited.edited);
  edited.redo();
  assert.equal(edited.base.number, 2);
  assert.ok(!edited.edited);
  edited.undo();
  assert.deepEqual(edited.base, BASE);
});
