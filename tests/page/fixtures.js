// Reads the fixtures that Python writes (fixtures.py), and compares with them.
import assert from "node:assert/strict";
import { readFileSync } from "node:fs";

export const fixture = (name) => JSON.parse(readFileSync(new URL(`./fixtures/${name}.json`, import.meta.url), "utf8"));

// Numbers in nested arrays, equal to `tolerance`.
export function assertClose(actual, expected, tolerance = 1e-12) {
  const [left, right] = [[...actual].flat(Infinity), expected.flat(Infinity)];
  assert.equal(left.length, right.length);
  left.forEach((value, i) => {
    assert.ok(Math.abs(value - right[i]) <= tolerance, `${value} instead of ${right[i]} at ${i}`);
  });
}
