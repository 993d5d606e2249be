// Which demonstrations of a task are listed, in which order: searched, filtered by verdict, mark or way, sorted.

/** @type {Record<string, string>} */
export const ORDERS = {
  newest: "newest first",
  oldest: "oldest first",
  verdict: "by verdict",
  way: "by way",
  duration: "shortest first",
};

/** @type {Record<string, string>} */
export const GROUPS = {
  all: "all",
  clean: "clean",
  repaired: "repaired",
  reject: "not usable",
  good: "marked good",
  bad: "marked bad",
  discarded: "discarded",
};

const WAY_GROUP_PREFIX = "way "; // and its number: the group of a way
const VERDICTS = ["reject", "repaired", "clean"]; // what needs a look comes first

/** @typedef {{search: string, group: string, order: string}} Filter */

/** @type {Filter} */
export const NO_FILTER = { search: "", group: "all", order: "newest" };

/**
 * The groups of a filter with their names: those of `GROUPS`, and one for each way.
 * @param {Map<string, number>} ways id of a demonstration -> its way
 * @returns {[string, string][]}
 */
export function groupsWithWays(ways) {
  const numbers = [...new Set(ways.values())].sort((a, b) => a - b);
  return [
    ...Object.entries(GROUPS),
    ...numbers.map((way) => /** @type {[string, string]} */ ([WAY_GROUP_PREFIX + way, WAY_GROUP_PREFIX + way])),
  ];
}

/**
 * The demonstrations that a filter finds, in its order. A number finds the demonstration of that number; other words are
 * looked for in source, station, verdict, mark and reasons.
 * @param {Demonstration[]} demonstrations in the order of their numbers
 * @param {Map<string, number>} ways
 * @param {Filter} filter
 */
export function filterDemonstrations(demonstrations, ways, { search, group, order }) {
  const words = search.toLowerCase().split(/\s+/).filter(Boolean);
  const found = demonstrations.filter(
    (d) => isOfGroup(d, ways.get(d.id), group) && words.every((word) => has(d, word)),
  );
  return sortNewest(found.reverse(), ways, order);
}

/** @param {Demonstration} demonstration @param {number | undefined} way @param {string} group */
function isOfGroup({ verdict, mark, discarded_ns }, way, group) {
  if (group === "all") return true;
  if (group === "discarded") return Boolean(discarded_ns);
  if (group === "good" || group === "bad") return mark === group;
  if (group.startsWith(WAY_GROUP_PREFIX)) return group === WAY_GROUP_PREFIX + way;
  return verdict === group && !discarded_ns;
}

/** @param {Demonstration} demonstration @param {string} word */
function has({ number, source, station, verdict, mark, reasons, advice }, word) {
  if (/^\d+$/.test(word)) return number === Number(word);
  return [source, station, verdict, mark, advice, ...reasons].some((text) => text.toLowerCase().includes(word));
}

/**
 * @param {Demonstration[]} newest newest first, sorted in place; equals stay newest first
 * @param {Map<string, number>} ways
 * @param {string} order
 */
function sortNewest(newest, ways, order) {
  const wayOf = (/** @type {Demonstration} */ { id }) => ways.get(id) ?? Number.POSITIVE_INFINITY;
  if (order === "oldest") return newest.reverse();
  if (order === "verdict") return newest.sort((a, b) => VERDICTS.indexOf(a.verdict) - VERDICTS.indexOf(b.verdict));
  if (order === "way") return newest.sort((a, b) => compare(wayOf(a), wayOf(b)));
  if (order === "duration") return newest.sort((a, b) => a.duration - b.duration);
  return newest;
}

/** @param {number} a @param {number} b either may be infinite */
const compare = (a, b) => (a === b ? 0 : a < b ? -1 : 1);
