import assert from "node:assert/strict";
import { test } from "node:test";
import { merged } from "../../clients/web/lists.js";
import { filterDemonstrations, NO_FILTER, ORDERS } from "../../clients/web/panels/demonstration_filter.js";

const VERDICTS = ["clean", "repaired", "reject"];
const all = Array.from({ length: 60 }, (_, i) => ({
  id: `d${i + 1}`,
  number: i + 1,
  source: i % 2 ? "glove" : "page",
  station: i % 4 ? "" : "cell-2",
  verdict: VERDICTS[i % 3],
  mark: i % 5 ? "" : "good",
  reasons: i % 3 ? [`${i} samples were lost`] : [],
  advice: "",
  duration: ((i * 7) % 60) + 1,
  discarded_ns: i % 11 ? 0 : 1,
}));
const ways = new Map(all.slice(0, 40).map(({ id }, i) => [id, (i % 2) + 1]));
const find = (filter) => filterDemonstrations(all, ways, { ...NO_FILTER, ...filter });

test("every order holds every demonstration once, and keeps to its rule", () => {
  const keys = {
    newest: (d) => -d.number,
    oldest: (d) => d.number,
    verdict: (d) => -VERDICTS.indexOf(d.verdict),
    way: (d) => ways.get(d.id) ?? 99,
    duration: (d) => d.duration,
  };
  assert.deepEqual(Object.keys(keys), Object.keys(ORDERS));
  for (const [order, key] of Object.entries(keys)) {
    const found = find({ order });
    assert.equal(new Set(found).size, all.length, order);
    assert.ok(
      found.every((d, i) => !i || key(found[i - 1]) <= key(d)),
      order,
    );
  }
  assert.equal(all[0].number, 1, "the list itself stays as it is");
});

test("what is filtered is what was asked for, and all of it", () => {
  const rules = {
    clean: (d) => d.verdict === "clean" && !d.discarded_ns,
    reject: (d) => d.verdict === "reject" && !d.discarded_ns,
    good: (d) => d.mark === "good",
    discarded: (d) => d.discarded_ns > 0,
    "way 2": (d) => ways.get(d.id) === 2,
  };
  for (const [group, rule] of Object.entries(rules)) {
    const found = find({ group, order: "oldest" });
    assert.ok(found.length > 0, group);
    assert.deepEqual(found, all.filter(rule), group);
  }
});

test("a number finds its demonstration, words find what all of them are in", () => {
  assert.deepEqual(
    find({ search: " 7 " }).map((d) => d.number),
    [7],
  );
  assert.deepEqual(
    find({ search: "GLOVE lost" }).reverse(),
    all.filter((d) => d.source === "glove" && d.reasons.length),
  );
  assert.deepEqual(
    find({ search: "cell-2" }).reverse(),
    all.filter((d) => d.station),
  );
  assert.deepEqual(find({ search: "moon" }), []);
});

test("what was read anew takes its place in a list", () => {
  const entry = (id, created_ns, number = created_ns) => ({ id, created_ns, number });
  const list = [entry("a", 1), entry("b", 2)];
  const fresh = [{ ...entry("b", 2), mark: "good" }, entry("c", 3)];
  assert.deepEqual(
    merged(list, fresh, false).map(({ id }) => id),
    ["a", "b", "c"],
  );
  assert.equal(merged(list, fresh, false)[1].mark, "good");
  assert.deepEqual(
    merged([...list].reverse(), fresh, true).map(({ id }) => id),
    ["c", "b", "a"],
  );
});
