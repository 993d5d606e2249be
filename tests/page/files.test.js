// Files before they are imported: columns that are chosen, marks, and the numbers of what was made.
import assert from "node:assert/strict";
import { test } from "node:test";
import { formatColumns, parseColumns, refusalSentence } from "../../clients/web/files/file_card.js";
import { fileRequest, ImportFile, numbered } from "../../clients/web/files/file_import.js";
import { nearestMark, timeAt } from "../../clients/web/files/motion_plot.js";

test("the columns that are chosen are written in the order of their roles and read again", () => {
  const text = formatColumns({ z: "4", t: "1", qw: "", x: "2" });
  assert.equal(text, "t=1,x=2,z=4");
  assert.deepEqual(parseColumns(text), { t: "1", x: "2", z: "4" });
  assert.deepEqual(parseColumns(""), {});
});

test("a press marks what is not marked yet, then the nearer one", () => {
  assert.equal(nearestMark({ grasp: null, release: null }, 3), "grasp");
  assert.equal(nearestMark({ grasp: 1, release: null }, 0.5), "release");
  assert.equal(nearestMark({ grasp: 1, release: 4 }, 2), "grasp");
  assert.equal(nearestMark({ grasp: 1, release: 4 }, 3), "release");
});

test("the time at a place of the plot lies within the motion", () => {
  const plot = /** @type {any} */ ({ getBoundingClientRect: () => ({ left: 100, width: 200 }) });
  assert.equal(timeAt(plot, 150, [0, 1, 8]), 2);
  assert.equal(timeAt(plot, 0, [0, 8]), 0);
  assert.equal(timeAt(plot, 900, [0, 8]), 8);
});

test("each demonstration has the number that follows in the order of the files", () => {
  const file = (/** @type {string} */ name, /** @type {number} */ made) =>
    /** @type {any} */ ({ name, report: { made: Array.from({ length: made }, () => ({})) } });
  const rows = numbered([file("a", 1), file("b", 2)], "7-9");
  assert.deepEqual(
    rows.map(({ name, made }) => [name, made.map(({ number }) => number)]),
    [
      ["a", [7]],
      ["b", [8, 9]],
    ],
  );
});

test("what a file leaves open is answered in the page, not by options of the command line", () => {
  const report = (/** @type {any} */ question, /** @type {string[]} */ columns = []) =>
    /** @type {any} */ ({ refusal: `${question.problem}; say it with --${question.option}`, question, columns });
  const time = { problem: "a.csv: t looks like ms", option: "time", values: ["ms"] };
  assert.equal(
    refusalSentence("a.csv", report(time)),
    "T looks like ms. Choose ms for “Time” under “Read it otherwise”.",
  );
  const columns = { problem: "a.csv, motion 2: no column for x", option: "columns", values: ["x=1"] };
  assert.equal(
    refusalSentence("a.csv", report(columns, ["a"])),
    "Motion 2: no column for x. Choose “Columns” under “Read it otherwise”.",
  );
  assert.equal(refusalSentence("a.csv", report(columns)), "Motion 2: no column for x"); // nothing to choose from
});

test("each motion has its own marks; without any, those that were found where that was sure", () => {
  const file = new ImportFile(/** @type {any} */ ({ name: "a.npy" }));
  file.report = /** @type {any} */ ({ motion: 1, unsure: [2], grasp: 1, release: 2 });
  assert.deepEqual(file.shownMarks, { grasp: 1, release: 2 });
  file.motion = 2;
  assert.deepEqual(file.shownMarks, { grasp: null, release: null }); // its report has not come
  file.choices = { ...file.choices, marks: { 2: { grasp: 3, release: null, whole: false } } };
  assert.deepEqual(file.shownMarks, { grasp: 3, release: null });
  assert.deepEqual(fileRequest(file).motion_marks, [{ motion: 2, grasp: 3, release: null, whole: false }]);
});
