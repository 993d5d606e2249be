// The demonstrations of the task: number, path in small, verdict with its reasons, duration, losses.
import { at, patch, post } from "../api.js";
import { command, element, facts, hint, number, plural, replace, sentence } from "../elements.js";
import { runOf } from "../store.js";
import { flattening, thumbnail } from "../thumbnail.js";
import { markFocus, pointAt, wayClass } from "./path_cards.js";

const LISTED = 60; // newest demonstrations
const SIGNS = { "": "☆", good: "★", bad: "⚑" };
const NEXT = { "": "good", good: "bad", bad: "" }; // mark that a press gives

export function takes(place, { store, gallery, attempt }) {
  pointAt(place, store);
  place.addEventListener("click", (event) => {
    const { verb, discard, restore, marked, mark } = event.target.closest("button")?.dataset ?? {};
    if (marked) attempt(() => patch(at("demonstrations", marked), { mark }));
    if (discard || restore) attempt(() => patch(at("demonstrations", discard ?? restore), { discarded: Boolean(discard) }));
    if (verb) attempt(() => post(at("tasks", store.state.task, "recording", verb)));
  });
  return {
    update(state, changed) {
      if (["demonstrations", "guidance", "task", "tasks", "runs", "run", "courses"].some((name) => changed.has(name))) {
        const list = place.querySelector(".takes");
        const scrolled = list?.scrollTop ?? 0;
        replace(place, content(state, gallery));
        place.querySelector(".takes")?.scrollTo(0, scrolled);
      }
      markFocus(place, state.focus); // also on what has just been drawn anew
    },
  };
}

function content(state, gallery) {
  const { task, tasks, demonstrations, guidance } = state;
  if (demonstrations === null && tasks === null) return hint("The demonstrations cannot be read yet: the service does not answer.");
  if (!demonstrations?.length) {
    return [hint("No demonstrations yet. Show the task with a tracker, or let a synthetic hand do it:"), command(`teachpath-client synthetic --task ${task || "demo"} --scene paper`)];
  }
  const kept = demonstrations.filter((d) => !d.discarded_ns);
  const count = (verdict) => kept.filter((d) => d.verdict === verdict).length;
  const mean = kept.reduce((sum, d) => sum + d.duration, 0) / kept.length;
  const ways = new Map((runOf(state)?.learned.clusters ?? []).flatMap((cluster) => cluster.members.map((id) => [id, cluster.index])));
  const courses = new Map(demonstrations.map((d) => [d.id, gallery.course(d.id)]).filter(([, course]) => course?.length > 1));
  const flat = flattening([...courses.values()]);
  const small = (d) => courses.has(d.id) && thumbnail(courses.get(d.id), flat, ways.has(d.id) ? wayClass(ways.get(d.id)) : "");
  return [
    element("p", { class: "count" }, element("strong", {}, String(kept.length)), ` ${plural(kept.length, "demonstration")}`),
    guidance[task] && element("p", { class: "guidance" }, `${sentence(guidance[task])}.`),
    facts([
      ["Clean", String(count("clean"))],
      ["Repaired", count("repaired") && String(count("repaired"))],
      ["Not usable", count("reject") && String(count("reject"))],
      ["Mean transport", kept.length > 0 && number(mean, 1, "s")],
      ["Samples lost", String(kept.reduce((sum, d) => sum + (d.account?.lost ?? 0), 0))],
    ]),
    element("ol", { class: "takes", "aria-label": "demonstrations, newest first" }, demonstrations.slice(-LISTED).reverse().map((d) => take(d, small(d)))),
    element("p", { class: "note" }, `${SIGNS[""]} marks one good, then bad: the bad ones are not learned from. × discards one; it can be brought back.`),
    element(
      "p",
      { class: "orders" },
      kept.length > 0 && element("button", { type: "button", "data-verb": "discard", "data-key": "discard" }, "Discard the last"),
      kept.length < demonstrations.length && element("button", { type: "button", "data-verb": "restore", "data-key": "restore" }, "Undo discard"),
    ),
    count("reject") < kept.length && saved(task),
  ];
}

// Files of all that is usable: for other programs, or to be imported again.
function saved(task) {
  const link = (format, name) => element("a", { href: `/api/v1/${at("tasks", task, "export")}?format=${format}`, download: "" }, name);
  return element("p", { class: "note saved" }, "Save them to files: ", link("mcap", "MCAP"), ", ", link("csv", "CSV"), " or ", link("lerobot", "LeRobot"), ".");
}

function take(d, small) {
  const why = [d.mark && `marked ${d.mark}`, d.trim && "trimmed", ...(d.reasons ?? [])].filter(Boolean).join("; ");
  const word = d.discarded_ns ? "discarded" : d.verdict;
  const [verb, sign, name] = d.discarded_ns ? ["restore", "↶", "Restore"] : ["discard", "×", "Discard"];
  const lost = d.account?.lost ?? 0;
  const next = NEXT[d.mark] ?? "";
  const marking = `Mark demonstration ${d.number} ${next || "neither good nor bad"}`;
  return element(
    "li",
    { class: word, value: String(d.number), "data-focus": `demonstrations ${d.id}` },
    element("span", { class: "number" }, String(d.number)),
    element("span", { class: "small" }, small),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, lost > 0 && `${lost} lost`),
    element("span", { class: "figure" }, number(d.duration, 1, "s")),
    element("button", { type: "button", class: "close", "data-marked": d.id, "data-mark": next, "data-key": `mark ${d.id}`, "aria-label": marking, title: marking }, SIGNS[d.mark] ?? SIGNS[""]),
    element("button", { type: "button", class: "close", [`data-${verb}`]: d.id, "data-key": `take ${d.id}`, "aria-label": `${name} demonstration ${d.number}`, title: name }, sign),
    why && element("span", { class: "why" }, sentence(why)),
  );
}
