// What a run was made with: settings, versions of the libraries, digests of what was learned from.
import { definitionList, element } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { changesAny } from "../store.js";

/** @param {HTMLElement} place @returns {Section} */
export function provenance(place) {
  return {
    update(state, changed) {
      const run = state.selectedRun;
      if (run && changesAny(changed, "runs", "selectedRun", "demonstrations")) {
        patchChildren(place, content(run, state.demonstrations ?? []));
      }
    },
  };
}

/** @param {Run} run @param {Demonstration[]} demonstrations @returns {Child[]} */
function content({ id, task, created_ns, learned }, demonstrations) {
  const { mode, settings, versions, inputs } = learned;
  const made = new Date(created_ns / 1e6).toISOString().slice(0, 16).replace("T", " ");
  /** @param {Record<string, unknown>} values */
  const facts = (values) =>
    definitionList(
      Object.entries(values).map(([name, value]) => /** @type {Fact} */ ([name, String(value ?? "automatic")])),
    );
  const rows = Object.entries(inputs).map(([key, digest]) => {
    const { number = key, source = "" } = demonstrations.find((one) => one.id === key) ?? {};
    return element("tr", {}, element("th", { scope: "row" }, number), element("td", {}, source, code(digest)));
  });
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
    element("h3", {}, "Demonstrations: source, SHA-256"),
    element("table", { class: "digests" }, element("tbody", {}, rows)),
  ];
}

/** @param {string} digest */
const code = (digest) => element("code", {}, digest);
