// What is known of all demonstrations of a task together: of those of the station that is shown, as the list below it.
import { ofShownStation } from "../stations.js";
import { formatNumber } from "../texts.js";

/**
 * How many are kept, and how they are; with `facts` empty where none is of the station that is shown.
 * @param {State} state
 * @returns {{count: number, facts: Fact[]}}
 */
export function demonstrationFacts(state) {
  const shown = ofShownStation(state, state.demonstrations);
  const kept = shown.filter(({ discarded_ns }) => !discarded_ns);
  return { count: kept.length, facts: shown.length > 0 ? facts(kept) : [] };
}

/** @param {Demonstration[]} kept @returns {Fact[]} */
function facts(kept) {
  /** @param {string} verdict */
  const count = (verdict) => kept.filter((d) => d.verdict === verdict).length;
  const mean = kept.reduce((sum, d) => sum + d.duration, 0) / kept.length;
  return [
    ["Clean", String(count("clean"))],
    ["Repaired", count("repaired")],
    ["Not usable", count("reject")],
    ["Mean transport", kept.length > 0 && formatNumber(mean, 1, "s")],
    ["Samples lost", String(kept.reduce((sum, d) => sum + d.statistics.lost, 0))],
  ];
}
