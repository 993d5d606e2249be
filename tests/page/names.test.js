import assert from "node:assert/strict";
import { test } from "node:test";
import { displayNameOf, idOf, taskTitle } from "../../clients/web/display_names.js";
import { isName, nameRefusal } from "../../clients/web/names.js";
import { fixture } from "./fixtures.js";

test("a name is one, and is refused in the words of the service", () => {
  const names = fixture("names");
  assert.ok(names.some(({ is_name }) => is_name) && names.some(({ is_name }) => !is_name));
  for (const { text, is_name, refusal } of names) {
    assert.equal(isName(text), is_name, text);
    assert.equal(nameRefusal("task", text), refusal);
  }
});

test("a name of any letters gives the id that the service makes of it", () => {
  for (const { text, id } of fixture("display_names")) assert.equal(idOf(text), id, text);
  assert.equal(displayNameOf(" Küche räumen "), "Küche räumen");
  assert.equal(displayNameOf("demo"), "");
});

test("a task is shown as people call it", () => {
  const tasks = [
    { name: "kueche", display_name: "Küche" },
    { name: "demo", display_name: "" },
  ];
  assert.deepEqual(
    ["kueche", "demo", "gone"].map((name) => taskTitle(tasks, name)),
    ["Küche", "demo", "gone"],
  );
});
