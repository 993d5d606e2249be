// The demonstrations of the task: number, path in small, verdict with its reasons, duration, losses.
import { at, post } from "../api.js";
import { command, element, facts, hint, number, plural, replace, sentence } from "../elements.js";

const LISTED = 60; // newest demonstrations

export function takes(place, { store, attempt }) {
  place.addEventListener("click", (event) => {
    const { verb } = event.target.closest("button")?.dataset ?? {};
    if (verb) attempt(() => post(at("tasks", store.state.task, "recording", verb)));
  });
  return {
    update(state, changed) {
      if (["demonstrations", "coach", "task", "tasks"].some((name) => changed.has(name))) replace(place, content(state));
    },
  };
}

function content({ task, tasks, demonstrations, coach }) {
  if (demonstrations === null && tasks === null) return hint("The demonstrations cannot be read yet: the service does not answer.");
  if (!demonstrations?.length) {
    return [hint("No demonstrations yet. Show the task with a tracker, or let a synthetic hand do it:"), command(`teachpath-client synthetic --task ${task || "demo"} --scene paper`)];
  }
  const kept = demonstrations.filter((d) => !d.discarded_ns);
  const count = (verdict) => kept.filter((d) => d.verdict === verdict).length;
  const mean = kept.reduce((sum, d) => sum + d.duration, 0) / kept.length;
  return [
    element("p", { class: "count" }, element("strong", {}, String(kept.length)), ` ${plural(kept.length, "demonstration")}`),
    coach[task] && element("p", { class: "coach" }, `${sentence(coach[task])}.`),
    facts([
      ["Clean", String(count("clean"))],
      ["Repaired", count("repaired") && String(count("repaired"))],
      ["Not usable", count("reject") && String(count("reject"))],
      ["Mean transport", kept.length > 0 && number(mean, 1, "s")],
      ["Samples lost", String(kept.reduce((sum, d) => sum + (d.account?.lost ?? 0), 0))],
    ]),
    element("ol", { class: "takes", "aria-label": "demonstrations, newest first" }, demonstrations.slice(-LISTED).reverse().map(take)),
    element(
      "p",
      { class: "orders" },
      kept.length > 0 && element("button", { type: "button", "data-verb": "discard", "data-key": "discard" }, "Discard the last"),
      kept.length < demonstrations.length && element("button", { type: "button", "data-verb": "restore", "data-key": "restore" }, "Undo discard"),
    ),
  ];
}

function take(d) {
  const why = [d.mark && `marked ${d.mark}`, ...(d.reasons ?? [])].filter(Boolean).join("; ");
  const word = d.discarded_ns ? "discarded" : d.verdict;
  return element(
    "li",
    { class: word, value: String(d.number), "data-demonstration": d.id },
    element("span", { class: "number" }, String(d.number)),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, number(d.duration, 1, "s")),
    why && element("span", { class: "why" }, sentence(why)),
  );
}
