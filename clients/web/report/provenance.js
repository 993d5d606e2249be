// What a run was made with: settings, versions of the libraries, digests of what was learned from.
import { definitionList, element } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { changesAny, demonstrationNumbers, selectedRun } from "../store.js";

/** @param {HTMLElement} place @returns {Section} */
export function provenance(place) {
  return {
    update(state, changed) {
      const run = selectedRun(state);
      if (run && changesAny(changed, "runs", "run", "demonstrations")) {
        patchChildren(place, content(run, demonstrationNumbers(state)));
      }
    },
  };
}

/** @param {Run} run @param {Map<string, number>} numbers @returns {Child[]} */
function content({ id, task, created_ns, learned }, numbers) {
  const { mode, settings, versions, inputs } = learned;
  const made = new Date(created_ns / 1e6).toISOString().slice(0, 16).replace("T", " ");
  /** @param {Record<string, unknown>} values */
  const facts = (values) =>
    definitionList(
      Object.entries(values).map(([name, value]) => /** @type {Fact} */ ([name, String(value ?? "automatic")])),
    );
  const digests = Object.entries(inputs).map(([demonstration, digest]) =>
    element("tr", {}, element("th", { scope: "row" }, numbers.get(demonstration) ?? demonstration), cell(digest)),
  );
  return [
    definitionList([
      ["Task", task],
      ["Run", id],
      ["Learned", `${made} UTC`],
      ["Mode", mode],
    ]),
    element("h3", {}, "Settings"),
    facts(settings),
    element("h3", {}, "Versions"),
    facts(versions),
    element("h3", {}, "SHA-256 of the demonstrations"),
    element("table", { class: "digests" }, element("tbody", {}, digests)),
  ];
}

/** @param {string} digest */
const cell = (digest) => element("td", {}, element("code", {}, digest));
