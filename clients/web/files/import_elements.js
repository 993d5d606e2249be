// What is said of an import: how it stands, how far it is, what became of each file.
import { element, progressBar } from "../elements.js";
import { verdictExplanation } from "../panels/demonstration_elements.js";
import { pluralize } from "../texts.js";

/** @param {import("./file_import.js").ImportFile[]} files */
export function standing(files) {
  const [refused, unsure] = [
    files.filter(({ error, report }) => error || report?.refusal),
    files.filter(({ report }) => report?.unsure.length),
  ];
  if (files.some(({ error, isExamined }) => !error && !isExamined)) return "Reading …";
  if (refused.length)
    return `${refused.length} of ${files.length} cannot be used: correct them, or leave them out. Nothing is imported before.`;
  if (unsure.length) return `${unsure.length} of ${files.length} would be kept as not usable until they are marked.`;
  return "All of them are imported, or none.";
}

/** @param {Job} job */
export function importProgress({ id, message, state, fraction }) {
  return element(
    "div",
    { class: "job", "data-key": "progress" },
    element("p", { role: "status" }, `Importing: ${message || state}`),
    element("button", { type: "button", "data-cancel": id, "data-key": "cancel import" }, "Cancel"),
    progressBar(fraction, "Import"),
  );
}

/** @param {ReturnType<typeof import("./file_import.js").numbered>} files */
export function importSummary(files) {
  const made = files.flatMap((file) => file.made);
  const rejected = made.filter(({ verdict }) => verdict === "reject").length;
  const head = `${made.length} ${pluralize(made.length, "demonstration")} of ${files.length} ${pluralize(files.length, "file")}${rejected ? `, ${rejected} not usable` : ""}.`;
  return element(
    "div",
    { "data-key": "summary" },
    element("p", { class: "count", role: "status" }, head),
    element(
      "ul",
      { class: "imported" },
      files.flatMap(({ name, made: rows }) =>
        rows.map((row) =>
          element(
            "li",
            { class: row.verdict },
            element("span", { class: "number" }, String(row.number)),
            element("span", { class: "name" }, name),
            element("span", { class: "verdict" }, row.verdict === "reject" ? "not usable" : row.verdict),
            verdictExplanation(row),
          ),
        ),
      ),
    ),
    element(
      "p",
      { class: "buttons" },
      element("button", { type: "button", "data-done": "1", "data-key": "done" }, "Done"),
    ),
  );
}
