// The demonstrations of the task: number, thumbnail, verdict with its reasons, duration, losses.
import { patch, post, resourcePath } from "../api.js";
import {
  capitalize,
  codeBlock,
  definitionList,
  element,
  formatNumber,
  hint,
  patchChildren,
  pluralize,
} from "../elements.js";
import { selectedRun } from "../store.js";
import { fitProjection, thumbnail } from "../thumbnail.js";
import { wayClass } from "../way_colors.js";
import { markFocus, trackFocus } from "./focus.js";

const MAX_LISTED = 60; // newest demonstrations
const MARK_SYMBOLS = { "": "☆", good: "★", bad: "⚑" };
const NEXT_MARK = { "": "good", good: "bad", bad: "" }; // mark that a press gives

export function demonstrationList(place, { store, sceneLayers, attempt }) {
  trackFocus(place, store);
  place.addEventListener("click", (event) => {
    const { verb, discard, restore, marked, mark } = event.target.closest("button")?.dataset ?? {};
    if (marked) attempt(() => patch(resourcePath("demonstrations", marked), { mark }));
    if (discard || restore)
      attempt(() => patch(resourcePath("demonstrations", discard ?? restore), { discarded: Boolean(discard) }));
    if (verb) attempt(() => post(resourcePath("tasks", store.state.task, "recording", verb)));
  });
  return {
    update(state, changed) {
      if (
        ["demonstrations", "guidance", "task", "tasks", "runs", "run", "trajectoriesLoaded"].some((name) =>
          changed.has(name),
        )
      ) {
        const list = place.querySelector(".demonstration-list");
        const scrolled = list?.scrollTop ?? 0;
        patchChildren(place, content(state, sceneLayers));
        place.querySelector(".demonstration-list")?.scrollTo(0, scrolled);
      }
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

function content(state, sceneLayers) {
  const { task, tasks, demonstrations, guidance } = state;
  if (demonstrations === null && tasks === null)
    return hint("The demonstrations cannot be read yet: the service does not answer.");
  if (!demonstrations?.length) {
    return [
      hint("No demonstrations yet. Show the task with a tracker, or let a synthetic hand do it:"),
      codeBlock(`teachpath-client synthetic --task ${task || "demo"} --scene paper`),
    ];
  }
  const kept = demonstrations.filter((d) => !d.discarded_ns);
  const count = (verdict) => kept.filter((d) => d.verdict === verdict).length;
  const mean = kept.reduce((sum, d) => sum + d.duration, 0) / kept.length;
  const ways = new Map(
    (selectedRun(state)?.learned.clusters ?? []).flatMap((cluster) => cluster.members.map((id) => [id, cluster.index])),
  );
  const trajectories = new Map(
    demonstrations.map((d) => [d.id, sceneLayers.trajectory(d.id)]).filter(([, trajectory]) => trajectory?.length > 1),
  );
  const flat = fitProjection([...trajectories.values()]);
  const preview = (d) =>
    trajectories.has(d.id) && thumbnail(trajectories.get(d.id), flat, ways.has(d.id) ? wayClass(ways.get(d.id)) : "");
  return [
    element(
      "p",
      { class: "count" },
      element("strong", {}, String(kept.length)),
      ` ${pluralize(kept.length, "demonstration")}`,
    ),
    guidance[task] && element("p", { class: "guidance" }, `${capitalize(guidance[task])}.`),
    definitionList([
      ["Clean", String(count("clean"))],
      ["Repaired", count("repaired") && String(count("repaired"))],
      ["Not usable", count("reject") && String(count("reject"))],
      ["Mean transport", kept.length > 0 && formatNumber(mean, 1, "s")],
      ["Samples lost", String(kept.reduce((sum, d) => sum + (d.account?.lost ?? 0), 0))],
    ]),
    element(
      "ol",
      { class: "demonstration-list", "aria-label": "demonstrations, newest first" },
      demonstrations
        .slice(-MAX_LISTED)
        .reverse()
        .map((d) => demonstrationRow(d, preview(d))),
    ),
    element(
      "p",
      { class: "note" },
      `${MARK_SYMBOLS[""]} marks one good, then bad: the bad ones are not learned from. × discards one; it can be brought back.`,
    ),
    element(
      "p",
      { class: "buttons" },
      kept.length > 0 &&
        element("button", { type: "button", "data-verb": "discard", "data-key": "discard" }, "Discard the last"),
      kept.length < demonstrations.length &&
        element("button", { type: "button", "data-verb": "restore", "data-key": "restore" }, "Undo discard"),
    ),
    count("reject") < kept.length && exportLinks(task),
  ];
}

// Files of all that is usable: for other programs, or to be imported again.
function exportLinks(task) {
  const link = (format, name) =>
    element("a", { href: `/api/v1/${resourcePath("tasks", task, "export")}?format=${format}`, download: "" }, name);
  return element(
    "p",
    { class: "note saved" },
    "Save them to files: ",
    link("mcap", "MCAP"),
    ", ",
    link("csv", "CSV"),
    " or ",
    link("lerobot", "LeRobot"),
    ".",
  );
}

function demonstrationRow(d, preview) {
  const why = [d.mark && `marked ${d.mark}`, d.trim && "trimmed", ...(d.reasons ?? [])].filter(Boolean).join("; ");
  const word = d.discarded_ns ? "discarded" : d.verdict;
  const [verb, sign, name] = d.discarded_ns ? ["restore", "↶", "Restore"] : ["discard", "×", "Discard"];
  const lost = d.account?.lost ?? 0;
  const next = NEXT_MARK[d.mark] ?? "";
  const marking = `Mark demonstration ${d.number} ${next || "neither good nor bad"}`;
  return element(
    "li",
    { class: word, value: String(d.number), "data-focus": `demonstrations ${d.id}` },
    element("span", { class: "number" }, String(d.number)),
    element("span", { class: "preview" }, preview),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, lost > 0 && `${lost} lost`),
    element("span", { class: "figure" }, formatNumber(d.duration, 1, "s")),
    element(
      "button",
      {
        type: "button",
        class: "close",
        "data-marked": d.id,
        "data-mark": next,
        "data-key": `mark ${d.id}`,
        "aria-label": marking,
        title: marking,
      },
      MARK_SYMBOLS[d.mark] ?? MARK_SYMBOLS[""],
    ),
    element(
      "button",
      {
        type: "button",
        class: "close",
        [`data-${verb}`]: d.id,
        "data-key": `discard ${d.id}`,
        "aria-label": `${name} demonstration ${d.number}`,
        title: name,
      },
      sign,
    ),
    why && element("span", { class: "why" }, capitalize(why)),
  );
}
