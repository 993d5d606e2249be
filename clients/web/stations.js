// Where several stations share a store: whose demonstrations, jobs and executions are shown.
import { option } from "./elements.js";
import { changesAny } from "./store.js";

const ALL_STATIONS = ""; // the choice of all stations

/**
 * The names of the stations that are known of: this one first, then those that something listed is of, by name.
 * @param {State} state
 * @returns {string[]}
 */
export function stationNames({ station, demonstrations, jobs, executions }) {
  const lists = [demonstrations, jobs, executions];
  const named = lists.flatMap((list) => (list ?? []).map((entry) => entry.station ?? ""));
  const own = station?.name ?? "";
  const others = [...new Set(named)].filter((name) => name && name !== own).sort();
  return own ? [own, ...others] : others;
}

/**
 * The station whose entries are shown: the chosen one, else this one; "" = all, as where there is one station alone.
 * @param {State} state
 */
export function shownStation(state) {
  const names = stationNames(state);
  const wanted = state.shownStation ?? state.station?.name ?? ALL_STATIONS;
  return names.length > 1 && names.includes(wanted) ? wanted : ALL_STATIONS;
}

/**
 * Those entries of a list that are of the shown station, or of none by name.
 * @template {{station?: string}} T
 * @param {State} state
 * @param {T[] | null} list
 * @returns {T[]}
 */
export function ofShownStation(state, list) {
  const shown = shownStation(state);
  return (list ?? []).filter(({ station }) => !shown || !station || station === shown);
}

/**
 * What returns the name of an entry's station where the entries of several are shown, else nothing.
 * @param {State} state
 * @returns {(entry: {station?: string}) => string}
 */
export function stationLabels(state) {
  const areSeveral = stationNames(state).length > 1 && shownStation(state) === ALL_STATIONS;
  return ({ station }) => (areSeveral && station) || "";
}

/** Tells a section when other stations are shown; jobs report several times a second. */
export class StationWatch {
  #seen = "";

  /**
   * Whether other stations are there or shown than when this was asked last.
   * @param {State} state
   * @param {Changed} changed
   */
  hasChanged(state, changed) {
    if (!changesAny(changed, "station", "shownStation", "demonstrations", "jobs", "executions")) return false;
    const seen = [shownStation(state), ...stationNames(state)].join("\n");
    const isOther = seen !== this.#seen;
    this.#seen = seen;
    return isOther;
  }
}

/**
 * Let a menu choose the station; it is hidden where there is one station alone.
 * @param {Context["store"]} store
 * @param {HTMLSelectElement} select in its label
 */
export function stationMenu(store, select) {
  select.addEventListener("change", () => store.set({ shownStation: select.value }));
  const watch = new StationWatch();
  store.subscribe((state, changed) => {
    if (!watch.hasChanged(state, changed)) return;
    const names = stationNames(state);
    if (select.parentElement) select.parentElement.hidden = names.length < 2;
    select.replaceChildren(...names.map((name) => option(name)), option(ALL_STATIONS, "all stations"));
    select.value = shownStation(state);
  });
}
