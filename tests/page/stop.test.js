import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { ArmStop } from "../../clients/web/arm/stop.js";

/** A stop whose service refuses so many tries; `wait(ms)` lets time pass. */
function stopThat(refusals) {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
  const sent = [];
  const states = [];
  const stop = new ArmStop(async (path) => {
    sent.push(path);
    if (sent.length <= refusals) throw new Error("NOT STOPPED");
  });
  stop.onChange = () => states.push(stop.state);
  const wait = async (ms) => {
    for (let passed = 0; passed < ms; passed += 50) {
      for (let turn = 0; turn < 10; turn += 1) await null;
      mock.timers.tick(50);
    }
  };
  return { stop, sent, states, wait };
}

test("a stop that is confirmed at once is never said to be none", async () => {
  const { stop, sent, states, wait } = stopThat(0);
  const confirmed = stop.request();
  await confirmed;
  await wait(1000);
  assert.deepEqual(states, ["stopping", ""]);
  assert.deepEqual(sent, ["stop"]);
});

test("without a confirmation it is NOT STOPPED after 0.3 s, and is tried until it is confirmed", async () => {
  const { stop, sent, states, wait } = stopThat(20);
  const confirmed = stop.request();
  await wait(250);
  assert.equal(stop.state, "stopping");
  await wait(100);
  assert.equal(stop.state, "not stopped");
  await wait(5000);
  await confirmed;
  assert.equal(sent.length, 21);
  assert.deepEqual(states, ["stopping", "not stopped", ""]);
});

test("a stop of whatever moves takes the place of one of an execution, and no other does", async () => {
  const { stop, sent, wait } = stopThat(2);
  const confirmed = stop.request("executions/one/stop");
  assert.equal(stop.request(), confirmed);
  assert.equal(stop.request("executions/two/stop"), confirmed);
  await wait(1000);
  await confirmed;
  assert.deepEqual(sent, ["executions/one/stop", "stop", "stop"]);
});

test("it can be pressed again after it was confirmed", async () => {
  const { stop, sent } = stopThat(0);
  await stop.request();
  await stop.request("executions/two/stop");
  assert.deepEqual(sent, ["stop", "executions/two/stop"]);
});
