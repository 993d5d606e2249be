// What past executions are called, and which of their plans are known.
import assert from "node:assert/strict";
import { test } from "node:test";
import { planNames } from "../../clients/web/panels/plan_names.js";

test("a plan is called by its task, its way and its version", () => {
  const plan = { id: "plan-1", task: "cup", path: "path-1", path_version: 3 };
  assert.equal(planNames([plan], [{ id: "path-1", cluster: 2 }], null).get("plan-1"), "cup, way 2, version 3");
  assert.equal(
    planNames([plan], [], [{ name: "cup", display_name: "Becher" }]).get("plan-1"),
    "Becher, a path, version 3",
  );
});
