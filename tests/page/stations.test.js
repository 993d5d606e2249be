// Whose demonstrations, jobs and executions are shown where several stations share a store.
import assert from "node:assert/strict";
import { test } from "node:test";
import { demonstrationFacts } from "../../clients/web/panels/demonstration_facts.js";
import { ofShownStation, StationWatch, shownStation, stationLabels, stationNames } from "../../clients/web/stations.js";
import { INITIAL_STATE } from "../../clients/web/store.js";

const [ours, theirs, nobodys] = ["cell-2", "cell-1", ""].map((station) => ({ id: `of ${station}`, station }));
const list = [ours, theirs, nobodys];
const at = (name, changes = {}) => ({ ...INITIAL_STATE, station: { name, notes: [] }, ...changes });

test("where there is one station alone, all is shown and nothing is named", () => {
  for (const state of [INITIAL_STATE, at(""), at("cell-2"), at("cell-2", { demonstrations: [ours, nobodys] })]) {
    assert.ok(stationNames(state).length < 2);
    assert.equal(shownStation(state), "");
    assert.deepEqual(ofShownStation(state, [ours, nobodys]), [ours, nobodys]);
    assert.equal(stationLabels(state)(ours), "");
  }
  assert.deepEqual(ofShownStation(INITIAL_STATE, null), []);
});

test("of several, this one is shown until another is chosen; all are shown with their names", () => {
  for (const lists of [{ demonstrations: list }, { jobs: list }, { executions: list }]) {
    const state = at("cell-2", lists);
    assert.deepEqual(stationNames(state), ["cell-2", "cell-1"]);
    assert.deepEqual(ofShownStation(state, list), [ours, nobodys]);
    assert.equal(stationLabels(state)(ours), "");
    const other = { ...state, shownStation: "cell-1" };
    assert.deepEqual(ofShownStation(other, list), [theirs, nobodys]);
    const all = { ...state, shownStation: "" };
    assert.deepEqual(ofShownStation(all, list), list);
    assert.deepEqual(list.map(stationLabels(all)), ["cell-2", "cell-1", ""]);
  }
});

test("a station of which nothing is listed any more hides nothing", () => {
  const state = at("cell-2", { demonstrations: list, shownStation: "cell-3" });
  assert.deepEqual(ofShownStation(state, list), list);
});

test("a section hears of other stations once, and not of what jobs report", () => {
  const [watch, alone] = [new StationWatch(), at("cell-2")];
  const several = at("cell-2", { jobs: list });
  assert.ok(watch.hasChanged(alone, new Set(["station"])));
  assert.ok(!watch.hasChanged(several, new Set(["recordings"])));
  assert.ok(watch.hasChanged(several, new Set(["jobs"])));
  assert.ok(!watch.hasChanged({ ...several, jobs: [...list] }, new Set(["jobs"])));
  assert.ok(watch.hasChanged({ ...several, shownStation: "" }, new Set(["shownStation"])));
});

test("what is said of all demonstrations is said of those that are listed", () => {
  const one = { verdict: "clean", discarded_ns: 0, duration: 2, statistics: { lost: 3 } };
  const made = list.flatMap(({ station }) => [
    { ...one, station },
    { ...one, station, discarded_ns: 7 },
  ]);
  for (const [shown, count] of [
    ["cell-2", 2],
    ["cell-1", 2],
    ["", 3],
  ]) {
    const known = demonstrationFacts(at("cell-2", { demonstrations: made, shownStation: shown }));
    assert.equal(known.count, count);
    const facts = Object.fromEntries(known.facts);
    assert.deepEqual([facts.Clean, facts["Samples lost"]], [String(count), String(3 * count)]);
  }
  const theirsAlone = at("cell-2", { demonstrations: [{ ...one, station: "cell-1" }] });
  assert.deepEqual(demonstrationFacts(theirsAlone), { count: 0, facts: [] });
});
