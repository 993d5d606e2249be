// The documents that the panels link to are there.
import assert from "node:assert/strict";
import { existsSync } from "node:fs";
import { test } from "node:test";
import { DOCUMENTS } from "../../clients/web/help_links.js";

test("every panel has documents, and each is one of the site", () => {
  assert.deepEqual(Object.keys(DOCUMENTS), ["demonstrate", "ways", "edit", "scene", "run"]);
  for (const [file] of Object.values(DOCUMENTS).flat()) {
    assert.ok(existsSync(new URL(`../../docs/${file}.md`, import.meta.url)), file);
  }
});
