import assert from "node:assert/strict";
import { mock, test } from "node:test";
import { ListReader } from "../../clients/web/lists.js";
import { Store } from "../../clients/web/store.js";

/** A service that answers with these statuses, one after the other, then with 200; 0: it does not answer. */
function reader(statuses, onList = () => {}) {
  mock.timers.reset();
  mock.timers.enable({ apis: ["setTimeout"] });
  const asked = [];
  globalThis.fetch = async (url) => {
    asked.push(url.pathname.split("/").at(-1));
    const status = statuses.shift() ?? 200;
    if (!status) throw new TypeError("Failed to fetch");
    return new Response(JSON.stringify(status === 200 ? [] : { detail: "no" }), { status });
  };
  const lists = [];
  const list = new ListReader(new Store(), async (name, entries) => {
    onList(name);
    lists.push([name, entries]);
  });
  return { list, asked, lists };
}

for (const status of [0, 429, 503]) {
  test(`a list that could not be read, by ${status || "no answer"}, is read again without an event`, async () => {
    const { list, asked, lists } = reader([status]);
    await list.read("tasks", "executions");
    assert.deepEqual(lists, [["executions", []]]);
    mock.timers.tick(3000);
    await list.read();
    assert.deepEqual(lists.at(-1), ["tasks", []]);
    assert.deepEqual(asked, ["tasks", "executions", "tasks"]);
  });
}

test("an entry that could not be read has its list read again", async () => {
  const { list, asked } = reader([200, 503]);
  list.store.set({ executions: [] });
  await list.read("executions");
  await list.readEntry("executions", "e1");
  mock.timers.tick(3000);
  await list.read();
  assert.deepEqual(asked, ["executions", "e1", "executions"]);
});

test("what is refused is not asked for again", async () => {
  const { list, asked, lists } = reader([403]);
  await list.read("tasks");
  mock.timers.tick(60_000);
  assert.equal(await list.read(), null);
  assert.deepEqual([asked, lists], [["tasks"], []]);
});

test("a list that could not be shown keeps no other from being read", async () => {
  const { list, lists } = reader([], (name) => {
    if (name === "tasks") throw new Error("broken");
  });
  await assert.rejects(list.read("tasks"), /broken/);
  await list.read("executions");
  assert.deepEqual(lists, [["executions", []]]);
});
