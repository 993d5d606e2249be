// The demonstrations of the task: number, thumbnail, verdict with its reasons, duration, losses.
import { patch, post, resourcePath } from "../api.js";
import { closestData, codeBlock, definitionList, element, hint } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { changesAny, waysOfDemonstrations } from "../store.js";
import { capitalize, formatNumber, pluralize } from "../texts.js";
import { fitProjection, thumbnail } from "../thumbnail.js";
import { wayClass } from "../way_colors.js";
import { markFocus, trackFocus } from "./focus.js";

const MAX_LISTED = 60; // newest demonstrations; a review package lists all of its run

/** @type {Record<string, string>} */
const MARK_SYMBOLS = { "": "☆", good: "★", bad: "⚑" };

/** @type {Record<string, string>} */
const NEXT_MARK = { "": "good", good: "bad", bad: "" }; // mark that a press gives
const AWAY = "The demonstrations cannot be read yet: the service does not answer.";
const NOTHING = "No demonstrations yet. Show the task with a tracker, or let a synthetic hand do it:";
const ABOUT_MARKS = `${MARK_SYMBOLS[""]} marks one good, then bad: the bad ones are not learned from. × discards one; it can be brought back.`;

/** @param {HTMLElement} place @param {Context} context @returns {Section} */
export function demonstrationList(place, { store, sceneLayers, attempt, readOnly }) {
  trackFocus(place, store);
  place.addEventListener("click", (event) => {
    const { verb, discard, restore, marked, mark } = closestData(event);
    if (marked) attempt(() => patch(resourcePath("demonstrations", marked), { mark }));
    const id = discard ?? restore;
    if (id) attempt(() => patch(resourcePath("demonstrations", id), { discarded: Boolean(discard) }));
    if (verb) attempt(() => post(resourcePath("tasks", store.state.task, "recording", verb)));
  });
  return {
    update(state, changed) {
      const isNew = changesAny(changed, "demonstrations", "guidance", "task", "tasks", "runs", "selectedRun");
      if (isNew || changed.has("trajectoriesLoaded")) {
        const scrolled = place.querySelector("ol")?.scrollTop ?? 0;
        patchChildren(place, content(state, sceneLayers.trajectories, readOnly));
        place.querySelector("ol")?.scrollTo(0, scrolled);
      }
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

/**
 * @param {State} state
 * @param {import("../trajectory_cache.js").TrajectoryCache} trajectories
 * @param {boolean} readOnly
 * @returns {Child}
 */
function content(state, trajectories, readOnly) {
  const { task, tasks, demonstrations, guidance } = state;
  if (demonstrations === null && tasks === null) return hint(AWAY);
  if (!demonstrations?.length) {
    return [hint(NOTHING), codeBlock(`teachpath-client synthetic --task ${task || "demo"} --scene paper`)];
  }
  const kept = demonstrations.filter((d) => !d.discarded_ns);
  const draw = thumbnailMaker(state, demonstrations, trajectories);
  const newest = demonstrations.slice(readOnly ? 0 : -MAX_LISTED).reverse();
  const count = element("strong", {}, String(kept.length));
  const usable = kept.filter(({ verdict }) => verdict !== "reject").length;
  return [
    element("p", { class: "count" }, count, ` ${pluralize(kept.length, "demonstration")}`),
    guidance[task] && element("p", { class: "guidance" }, `${capitalize(guidance[task])}.`),
    definitionList(facts(kept)),
    element(
      "ol",
      { class: "demonstration-list", "aria-label": "demonstrations, newest first" },
      newest.map((d) => demonstrationRow(d, draw(d.id), readOnly)),
    ),
    !readOnly && [
      element("p", { class: "note" }, ABOUT_MARKS),
      discardButtons(kept.length, demonstrations.length),
      usable > 0 && exportLinks(task),
    ],
  ];
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

/**
 * What draws demonstrations in small, all on one scale; nothing where the trajectory is not here.
 * @param {State} state
 * @param {Demonstration[]} demonstrations
 * @param {import("../trajectory_cache.js").TrajectoryCache} trajectories
 */
function thumbnailMaker(state, demonstrations, trajectories) {
  const ways = waysOfDemonstrations(state);
  const projection = fitProjection(demonstrations.flatMap(({ id }) => [trajectories.get(id) ?? []]));
  /** @param {string} id */
  return (id) => {
    const [points, way] = [trajectories.get(id), ways.get(id)];
    return points && thumbnail(points, projection, way ? wayClass(way) : "");
  };
}

/** @param {number} kept @param {number} all */
function discardButtons(kept, all) {
  /** @param {string} verb @param {string} text */
  const button = (verb, text) => element("button", { type: "button", "data-verb": verb, "data-key": verb }, text);
  const [discard, restore] = [button("discard", "Discard the last"), button("restore", "Undo discard")];
  return element("p", { class: "buttons" }, kept > 0 && discard, kept < all && restore);
}

/**
 * Files of all that is usable: for other programs, or to be imported again.
 * @param {string} task
 */
function exportLinks(task) {
  const path = `/api/v1/${resourcePath("tasks", task, "export")}`;
  /** @param {string} format @param {string} name */
  const link = (format, name) => element("a", { href: `${path}?format=${format}`, download: "" }, name);
  const [mcap, csv, lerobot] = [link("mcap", "MCAP"), link("csv", "CSV"), link("lerobot", "LeRobot")];
  return element("p", { class: "note saved" }, "Save them to files: ", mcap, ", ", csv, " or ", lerobot, ".");
}

/** @param {Demonstration} demonstration @param {Child} preview @param {boolean} readOnly */
function demonstrationRow(demonstration, preview, readOnly) {
  const { id, number, verdict, mark, trim, reasons, duration, discarded_ns, statistics } = demonstration;
  const why = [mark && `marked ${mark}`, trim && "trimmed", ...reasons].filter(Boolean).join("; ");
  const word = discarded_ns ? "discarded" : verdict;
  return element(
    "li",
    { class: word, value: String(number), "data-focus": `demonstrations ${id}` },
    element("span", { class: "number" }, String(number)),
    element("span", { class: "preview" }, preview),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, statistics.lost > 0 && `${statistics.lost} lost`),
    element("span", { class: "figure" }, formatNumber(duration, 1, "s")),
    !readOnly && rowButtons(demonstration),
    why && element("span", { class: "why" }, capitalize(why)),
  );
}

/** @param {Demonstration} demonstration */
function rowButtons({ id, number, mark, discarded_ns }) {
  const [verb, sign, name] = discarded_ns ? ["restore", "↶", "Restore"] : ["discard", "×", "Discard"];
  const next = NEXT_MARK[mark] ?? "";
  const marking = `Mark demonstration ${number} ${next || "neither good nor bad"}`;
  const markLabel = { "aria-label": marking, title: marking };
  const discardLabel = { "aria-label": `${name} demonstration ${number}`, title: name };
  const button = { type: "button", class: "close" };
  return [
    element(
      "button",
      { ...button, ...markLabel, "data-marked": id, "data-mark": next, "data-key": `mark ${id}` },
      MARK_SYMBOLS[mark] ?? MARK_SYMBOLS[""],
    ),
    element("button", { ...button, ...discardLabel, [`data-${verb}`]: id, "data-key": `discard ${id}` }, sign),
  ];
}
