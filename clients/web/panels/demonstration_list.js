// The demonstrations of the task: what is known of all, and a list of them to search, filter, sort and page through.
import { patch, post, resourcePath } from "../api.js";
import { blocked, closestData, codeBlock, definitionList, element, hint, option } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { ofShownStation, StationWatch, shownStation, stationLabels } from "../stations.js";
import { changesAny, waysOfDemonstrations } from "../store.js";
import { capitalize, pluralize } from "../texts.js";
import { demonstrationFacts } from "./demonstration_facts.js";
import { filterDemonstrations, groupsWithWays, NO_FILTER, ORDERS } from "./demonstration_filter.js";
import { demonstrationRow, MARK_SYMBOLS, thumbnailMaker } from "./demonstration_rows.js";
import { DemonstrationSelection } from "./demonstration_selection.js";
import { markFocus, trackFocus } from "./focus.js";

const PAGE_SIZE = 60; // rows that are shown at a time
const SEARCH_THRESHOLD = 10; // demonstrations that are overlooked without searching
const SERVICE_AWAY_SENTENCE = "The demonstrations cannot be read yet: the service does not answer.";
const NO_DEMONSTRATIONS_SENTENCE =
  "No demonstrations yet. Show the task with a tracker, or let a synthetic hand do it:";
const ABOUT_MARKS = `${MARK_SYMBOLS[""]} marks one good, then bad: the bad ones are not learned from. × discards one; it can be brought back.`;

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function demonstrationList(place, { store, sceneLayers, attempt, readOnly }) {
  let [filter, page] = [NO_FILTER, 0];
  const watch = new StationWatch();
  const selection = new DemonstrationSelection(() => render(store.state));
  const tools = filterTools((chosen) => {
    [filter, page] = [chosen, 0];
    render(store.state);
  });
  const [head, several, rows, foot] = ["div", "div", "div", "div"].map((tag) =>
    element(/** @type {"div"} */ (tag), {}),
  );
  place.append(head, tools.element, several, rows, foot);
  trackFocus(place, store);
  place.addEventListener("click", (event) => {
    const { verb, discard, restore, marked, mark, turn, select, change } = closestData(event);
    if (select === "all") selection.toggleAll(filtered(store.state));
    else if (select) selection.turn(select === "on");
    if (change) attempt(() => selection.change(change));
    if (marked) attempt(() => patch(resourcePath("demonstrations", marked), { mark }));
    const id = discard ?? restore;
    if (id) attempt(() => patch(resourcePath("demonstrations", id), { discarded: Boolean(discard) }));
    if (verb) attempt(() => post(resourcePath("tasks", store.state.task, "recording", verb)));
    if (!turn) return;
    page += Number(turn);
    render(store.state);
    rows.querySelector("ol")?.scrollTo(0, 0);
  });

  place.addEventListener("change", ({ target }) => {
    if (target instanceof HTMLInputElement && target.dataset.chosen)
      selection.choose(target.dataset.chosen, target.checked);
    if (!(target instanceof HTMLSelectElement) || !target.dataset.move || !target.value) return;
    attempt(() => selection.move(target.value));
  });

  /** @param {State} state */
  const filtered = (state) =>
    filterDemonstrations(ofShownStation(state, state.demonstrations), waysOfDemonstrations(state), filter);

  /** @param {State} state */
  function render(state) {
    const [ways, all] = [waysOfDemonstrations(state), ofShownStation(state, state.demonstrations)];
    const found = filtered(state);
    page = Math.max(0, Math.min(page, Math.ceil(found.length / PAGE_SIZE) - 1));
    const shown = found.slice(page * PAGE_SIZE, (page + 1) * PAGE_SIZE);
    if (!readOnly) sceneLayers.trajectories.request(shown);
    tools.update(all.length > SEARCH_THRESHOLD, groupsWithWays(ways));
    patchChildren(head, summary(state));
    const others = (state.tasks ?? []).filter(({ name }) => name !== state.task);
    patchChildren(several, !readOnly && all.length > 1 && selection.toolbar(found, others));
    const scrolled = rows.querySelector("ol")?.scrollTop ?? 0;
    patchChildren(
      rows,
      all.length > 0 && list(state, shown, sceneLayers.trajectories, readOnly, selection.isOn ? selection.ids : null),
      pager(found.length, page),
    );
    for (const box of rows.querySelectorAll("input")) box.checked = box.hasAttribute("checked");
    rows.querySelector("ol")?.scrollTo(0, scrolled);
    const ofTask = state.demonstrations ?? []; // its orders and files are for all stations
    patchChildren(foot, !readOnly && ofTask.length > 0 && orders(state.task, ofTask));
  }

  return {
    update(state, changed) {
      if (changed.has("task")) {
        [filter, page] = [tools.reset(), 0];
        selection.turn(false);
      }
      const isNew = changesAny(changed, "demonstrations", "guidance", "task", "tasks", "runs", "selectedRun");
      if (watch.hasChanged(state, changed) || isNew || changed.has("trajectoriesLoaded")) render(state);
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

/**
 * The controls of a filter: what is searched, which group is shown, in which order.
 * @param {(filter: import("./demonstration_filter.js").Filter) => void} onChoice
 */
function filterTools(onChoice) {
  const search = element("input", { type: "search", placeholder: "Search", "aria-label": "Search demonstrations" });
  const group = element("select", { "aria-label": "Show demonstrations" });
  const order = element("select", { "aria-label": "Order of demonstrations" });
  order.append(...Object.entries(ORDERS).map(([value, text]) => option(value, text)));
  const choose = () => onChoice({ search: search.value, group: group.value, order: order.value });
  for (const control of [search, group, order]) control.addEventListener("input", choose);
  let names = "";
  return {
    element: element("div", { class: "filter", hidden: "" }, search, group, order),
    /** @param {boolean} isShown @param {[string, string][]} groups */
    update(isShown, groups) {
      if (search.parentElement) search.parentElement.hidden = !isShown;
      if (names === JSON.stringify(groups)) return;
      const chosen = group.value;
      group.replaceChildren(...groups.map(([value, text]) => option(value, text)));
      group.value = groups.some(([value]) => value === chosen) ? chosen : NO_FILTER.group;
      names = JSON.stringify(groups);
    },
    reset() {
      [search.value, group.value, order.value] = [NO_FILTER.search, NO_FILTER.group, NO_FILTER.order];
      return NO_FILTER;
    },
  };
}

/**
 * What is known of all demonstrations together that are listed.
 * @param {State} state
 * @returns {Child}
 */
function summary(state) {
  const { task, tasks, demonstrations, guidance } = state;
  if (demonstrations === null && tasks === null) return hint(SERVICE_AWAY_SENTENCE);
  if (!demonstrations?.length) {
    return [
      hint(NO_DEMONSTRATIONS_SENTENCE),
      codeBlock(`teachpath-client synthetic --task ${task || "demo"} --scene paper`),
    ];
  }
  const { count, facts } = demonstrationFacts(state);
  if (!facts.length) return hint(`No demonstration of ${shownStation(state)} yet; the header shows those of others.`);
  return [
    element(
      "p",
      { class: "count" },
      element("strong", {}, count.toLocaleString("en")),
      ` ${pluralize(count, "demonstration")}`,
    ),
    guidance[task] && element("p", { class: "guidance" }, `${capitalize(guidance[task])}.`),
    definitionList(facts),
  ];
}

/**
 * @param {State} state
 * @param {Demonstration[]} shown
 * @param {import("../trajectory_cache.js").TrajectoryCache} trajectories
 * @param {boolean} readOnly
 * @param {Set<string> | null} chosen ids of those that are selected; null: nothing is selected here
 */
function list(state, shown, trajectories, readOnly, chosen) {
  if (!shown.length) return hint("No demonstration is like that: search for less, or show all.");
  const [draw, stationOf] = [thumbnailMaker(state, shown, trajectories), stationLabels(state)];
  return element(
    "ol",
    { class: "demonstration-list", "aria-label": "demonstrations" },
    shown.map((d) => demonstrationRow(d, draw(d.id), readOnly, chosen, stationOf(d))),
  );
}

/** @param {number} found @param {number} page */
function pager(found, page) {
  if (found <= PAGE_SIZE) return null;
  const [first, last] = [page * PAGE_SIZE + 1, Math.min(found, (page + 1) * PAGE_SIZE)];
  /** @param {number} turn @param {string} sign @param {string} name @param {string} why */
  const button = (turn, sign, name, why) =>
    element(
      "button",
      { type: "button", "data-turn": turn, "data-key": name, "aria-label": name, ...blocked(why) },
      sign,
    );
  const pages = Math.ceil(found / PAGE_SIZE);
  const [isFirst, isLast] = [
    page > 0 ? "" : "This is the first page.",
    page < pages - 1 ? "" : "This is the last page.",
  ];
  return element(
    "p",
    { class: "pager" },
    button(-page, "«", "First page", isFirst),
    button(-1, "‹", "Page before", isFirst),
    element("span", { role: "status" }, `${first} to ${last} of ${found.toLocaleString("en")}`),
    button(1, "›", "Next page", isLast),
    button(pages - 1 - page, "»", "Last page", isLast),
  );
}

/** @param {string} task @param {Demonstration[]} all */
function orders(task, all) {
  const kept = all.filter((d) => !d.discarded_ns);
  return [
    element("p", { class: "note" }, ABOUT_MARKS),
    discardButtons(kept.length, all.length),
    exportLinks(
      task,
      kept.some(({ verdict }) => verdict !== "reject"),
    ),
  ];
}

/** @param {number} kept @param {number} all */
function discardButtons(kept, all) {
  /** @param {string} verb @param {string} text */
  const button = (verb, text) => element("button", { type: "button", "data-verb": verb, "data-key": verb }, text);
  const [discard, restore] = [button("discard", "Discard the last"), button("restore", "Undo discard")];
  return element("p", { class: "buttons" }, kept > 0 && discard, kept < all && restore);
}

/**
 * Files of what is usable: for other programs, or to be imported again; and all of the task in one archive.
 * @param {string} task
 * @param {boolean} isUsable whether any demonstration is
 */
function exportLinks(task, isUsable) {
  const path = `api/v1/${resourcePath("tasks", task, "export")}`;
  /** @param {string} format @param {string} name */
  const link = (format, name) => element("a", { href: `${path}?format=${format}`, download: "" }, name);
  const [mcap, csv, lerobot] = [link("mcap", "MCAP"), link("csv", "CSV"), link("lerobot", "LeRobot")];
  const all = link("archive&all=true", "Download everything of this task");
  return [
    isUsable && element("p", { class: "note saved" }, "Save them to files: ", mcap, ", ", csv, " or ", lerobot, "."),
    element(
      "p",
      { class: "note saved" },
      all,
      ": one archive, also of what was rejected or discarded, with checksums.",
    ),
  ];
}
