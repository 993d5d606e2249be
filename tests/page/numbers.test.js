// Numbers as people type them, and what refuses others.
import assert from "node:assert/strict";
import { test } from "node:test";
import { parseNumber, readNumber } from "../../clients/web/number_input.js";

test("a number is read with point or comma, and in other units than the field's", () => {
  const read = { 484.9: 484.9, "484,9": 484.9, " −3,5 mm": -3.5, "12 cm": 120, "0,4 m": 400, ",5": 0.5, "1e2": 100 };
  for (const [text, value] of Object.entries(read)) assert.deepEqual(parseNumber(text, "mm"), { value }, text);
  assert.ok(Math.abs((parseNumber("3.14159265359 rad", "°").value ?? 0) - 180) < 1e-6);
  assert.deepEqual(parseNumber("350 g", "kg"), { value: 0.35 });
});

test("what may mean two numbers, or none, is refused in words", () => {
  assert.equal(parseNumber("1,234", "mm").fault, "may be 1.234 or 1234: write one of them");
  for (const text of ["1.234,5", "12 kg", "a", "1 2", "--1", "1e999", "."])
    assert.equal(parseNumber(text, "mm").fault, "must be a number, alone or in mm, cm, m, in", text);
  assert.equal(parseNumber("1 mm").fault, "must be a number");
});

test("a field refuses what is beyond its limits, and nothing", () => {
  /** @param {string} value */
  const field = (value) => /** @type {any} */ ({ value, dataset: { min: "-10", max: "10", unit: "mm" } });
  assert.deepEqual(readNumber(field("1 cm")), { value: 10 });
  for (const text of ["", " ", "1,1 cm", "-11"])
    assert.equal(readNumber(field(text)).fault, "must be a number from -10 to 10 mm");
});
