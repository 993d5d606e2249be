import assert from "node:assert/strict";
import { test } from "node:test";
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
