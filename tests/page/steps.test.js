// Which steps of the work the page says are done.
import assert from "node:assert/strict";
import { test } from "node:test";
import { doneSteps } from "../../clients/web/steps.js";
import { INITIAL_STATE } from "../../clients/web/store.js";

const PATH = { id: "p", cluster: 1, version: 2 };
const PLAN = { id: "plan", path: "p", path_version: 2 };
const RUN = { id: "run", learned: { paths: [PATH], clusters: [] } };
const FINISHED_PLAN = { plan: "plan", status: { state: "ended", progress: 1 } };

/** @param {object} changes */
const steps = (changes) => [...doneSteps({ ...INITIAL_STATE, ...changes })];

test("nothing is done before anything is known, and each step when its work is there", () => {
  assert.deepEqual(steps({}), []);
  const shown = { demonstrations: [{ verdict: "clean", discarded_ns: 0 }] };
  assert.deepEqual(steps(shown), ["demonstrate"]);
  const learned = { ...shown, selectedRun: RUN };
  assert.deepEqual(steps(learned), ["demonstrate", "ways"]);
  const planned = { ...learned, plan: PLAN };
  assert.deepEqual(steps(planned), ["demonstrate", "ways", "edit"]);
  assert.deepEqual(steps({ ...planned, executions: [FINISHED_PLAN] }), ["demonstrate", "ways", "edit", "run"]);
});

test("what cannot be learned from, is not certified in its newest version or was broken off is not done", () => {
  const useless = [
    { verdict: "reject", discarded_ns: 0 },
    { verdict: "clean", discarded_ns: 7 },
  ];
  assert.deepEqual(steps({ demonstrations: useless }), []);
  assert.deepEqual(steps({ selectedRun: RUN, plan: { ...PLAN, path_version: 1 } }), ["ways"]);
  const stopped = { plan: "plan", status: { state: "ended", progress: 0.4 } };
  const other = { plan: "another", status: { state: "ended", progress: 1 } };
  assert.deepEqual(steps({ selectedRun: RUN, plan: PLAN, executions: [stopped, other] }), ["ways", "edit"]);
});
