// What may be done with a task, and what the log says of the list of tasks.
import assert from "node:assert/strict";
import { test } from "node:test";
import { taskListChanges } from "../../clients/web/event_log.js";
import { INITIAL_STATE } from "../../clients/web/store.js";
import { changeRefusal } from "../../clients/web/task_menu.js";

/** @param {object} changes */
const refusal = (changes) => changeRefusal({ ...INITIAL_STATE, task: "demo", ...changes });

test("a task may be changed at rest, by whoever may teach, and each reason against it is said", () => {
  assert.equal(refusal({}), "");
  assert.equal(refusal({ jobs: [{ state: "succeeded" }], recordings: [{ task: "another", tracker: "glove" }] }), "");
  assert.match(refusal({ task: "" }), /no task yet/);
  assert.match(refusal({ recordings: [{ task: "demo", tracker: "glove" }] }), /recorded from glove/);
  for (const state of ["queued", "running"]) assert.match(refusal({ jobs: [{ state }] }), /wait for that/);
  assert.match(refusal({ identity: { name: "otto", capabilities: ["view"] } }), /needs the role “teach”/);
});

test("the log says of each task whether it was made, renamed, deleted or brought back", () => {
  const [one, two] = [
    { name: "one", created_ns: 1 },
    { name: "two", created_ns: 2 },
  ];
  assert.deepEqual(taskListChanges(null, [one]), []);
  assert.deepEqual(taskListChanges([one], [one]), []);
  assert.deepEqual(taskListChanges([one], [one, two]), ["Task two was made"]);
  assert.deepEqual(taskListChanges([two], [one, two]), ["Task one was brought back"]);
  assert.deepEqual(taskListChanges([one, two], [two]), ["Task one was deleted; it is kept"]);
  assert.deepEqual(taskListChanges([one, two], [{ ...one, name: "three" }, two]), ["Task one is called three now"]);
});
