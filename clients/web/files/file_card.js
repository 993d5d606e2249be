// One file before it is imported: what was understood, its motion with the marks, what would be made, and corrections.
import { element, option } from "../elements.js";
import { numberInput } from "../number_input.js";
import { verdictExplanation } from "../panels/demonstration_elements.js";
import { capitalize, formatNumber, pluralize } from "../texts.js";
import { isMarked } from "./file_import.js";
import { motionPlot } from "./motion_plot.js";

/** @typedef {import("./file_import.js").ImportFile} ImportFile */

/** @typedef {{name: string, title: string}} ReaderName */

const ROLES = ["t", "x", "y", "z", "qw", "qx", "qy", "qz", "number", "tracked", "grasp", "flexion"];

/** @type {Record<string, string>} */
const ROLE_NAMES = { t: "time", number: "number", tracked: "tracked", grasp: "grasp", flexion: "flexion" };
const UNSURE =
  "Not sure where the object was taken and put: press on the curve where the hand takes it, then where it puts it.";
const OTHER_READING = "Read it otherwise";
const MAX_RATE = 1_000_000; // [Hz] no file of motion is sampled as often
/** Where the page answers what a file leaves open. @type {Record<string, string>} */
const FIELDS = { columns: "Columns", time: "Time", track: "Body, marker or topic", units: "Lengths" };

/** @type {Record<string, [string, string][]>} */
const OPTIONS = {
  units: [
    ["", "as found"],
    ["m", "m"],
    ["cm", "cm"],
    ["mm", "mm"],
    ["in", "in"],
  ],
  time: [
    ["", "as found"],
    ["s", "s"],
    ["ms", "ms"],
    ["us", "µs"],
    ["ns", "ns"],
  ],
  quaternion: [
    ["", "as found"],
    ["wxyz", "w, x, y, z"],
    ["xyzw", "x, y, z, w"],
  ],
};

/**
 * @param {ImportFile} file
 * @param {{isOpen: boolean, isOnly: boolean, readers: ReaderName[]}} context
 */
export function fileCard(file, { isOpen, isOnly, readers }) {
  const { id, name, report } = file;
  const toggle = {
    type: "button",
    class: "name",
    "data-toggle": id,
    "data-key": `toggle ${id}`,
    "aria-expanded": isOpen,
  };
  const close = { type: "button", class: "close", "data-remove": id, "data-key": `remove ${id}` };
  return element(
    "article",
    { class: `card file ${isOpen ? "chosen" : ""}`, "data-key": `file ${id}` },
    element(
      "header",
      {},
      element("h3", {}, element("button", toggle, name)),
      element("span", { class: `status ${statusClass(file)}` }, status(file)),
      element("button", { ...close, "aria-label": `Leave out ${name}`, title: "Leave out" }, "×"),
    ),
    isOpen && file.error && failure(file),
    isOpen && report && examination(file, report, { isOnly, readers }),
  );
}

/** What is said of a file in a word. @param {ImportFile} file */
export function status({ error, upload, isExamined, report }) {
  if (error) return "failed";
  if (!upload) return "sending …";
  if (!isExamined || !report) return "reading …";
  if (report.refusal) return "cannot be used";
  if (report.unsure.length) return "mark it";
  const words = [...new Set(report.made.map(({ verdict }) => (verdict === "reject" ? "not usable" : verdict)))];
  const count = report.made.length;
  return count === 1 ? words.join() : `${count} ${pluralize(count, "demonstration")}, ${words.join(", ")}`;
}

/** @param {ImportFile} file */
function statusClass({ error, isExamined, report }) {
  if (error || (isExamined && report?.refusal)) return "failed";
  return isExamined && (!report || report.unsure.length > 0 || report.made.some(({ verdict }) => verdict === "reject"))
    ? "failed"
    : "";
}

/** @param {ImportFile} file */
function failure({ id, error }) {
  const again = element("button", { type: "button", "data-again": id, "data-key": `again ${id}` }, "Try again");
  return [element("p", { class: "failed" }, error), element("p", { class: "buttons" }, again)];
}

/** @param {ImportFile} file @param {FileReport} report @param {{isOnly: boolean, readers: ReaderName[]}} context */
function examination(file, report, { isOnly, readers }) {
  const { id, shownMarks } = file;
  const isUnsure = report.unsure.includes(report.motion) && !report.refusal;
  return [
    report.refusal && element("p", { class: "failed" }, refusalSentence(file.name, report)),
    report.imported_before && element("p", { class: "failed" }, capitalize(report.imported_before)),
    report.motions > 1 && motionField(file, report),
    isUnsure && element("p", { class: "failed" }, UNSURE),
    report.times.length > 1 && motionPlot(id, report, shownMarks),
    report.times.length > 1 && markFields(file, shownMarks),
    report.made.map((made) => element("p", { class: "note" }, madeText(made), verdictExplanation(made))),
    element(
      "ul",
      { class: "understood" },
      report.understood.map((phrase) => element("li", {}, phrase)),
    ),
    corrections(file, report, isOnly, readers),
  ];
}

/** Why a file cannot be used, and where the page mends that. @param {string} name @param {FileReport} report */
export function refusalSentence(name, { refusal, question, columns }) {
  const said = question?.problem ?? refusal;
  const sentence = capitalize(said.startsWith(name) ? said.slice(name.length).replace(/^[:,] /, "") : said);
  if (!question || (question.option === "columns" && !columns.length)) return sentence;
  const values = question.option === "time" || question.option === "units" ? question.values : []; // names are in the list
  const choice = values.length ? `${values.join(" or ")} for ` : "";
  return `${sentence}. Choose ${choice}“${FIELDS[question.option] ?? question.option}” under “${OTHER_READING}”.`;
}

/** Which motion of several is shown and marked. @param {ImportFile} file @param {FileReport} report */
function motionField({ id, motion, choices }, { motions, unsure }) {
  const names = Array.from({ length: motions }, (_, k) => {
    const state = unsure.includes(k + 1) ? ": mark it" : isMarked(choices.marks[k + 1]) ? ": marked" : "";
    return /** @type {[string, string]} */ ([String(k + 1), `${k + 1} of ${motions}${state}`]);
  });
  return selectField(id, "motion", "Motion", names, String(motion));
}

/** @param {Demonstration} made */
function madeText({ samples, duration, verdict }) {
  const word = verdict === "reject" ? "not usable" : verdict;
  return `${capitalize(word)}: ${samples} samples, ${formatNumber(duration, 2, "s")} carried. `;
}

/** @param {ImportFile} file @param {{grasp: number | null, release: number | null}} marks */
function markFields({ id, said, report }, { grasp, release }) {
  const end = report?.times.at(-1) ?? 0;
  /** @param {string} field @param {string} name @param {number | null} value */
  const seconds = (field, name, value) => {
    const input = { min: 0, max: end, unit: "s", step: 0.02, "data-field": field, "data-file": id };
    return element(
      "label",
      {},
      name,
      numberInput({
        ...input,
        value: value === null ? "" : Number(value.toFixed(3)),
        "data-key": `${field} ${id}`,
      }),
      "s",
    );
  };
  const whole = { type: "checkbox", "data-field": "whole", "data-file": id, "data-key": `whole ${id}` };
  return element(
    "p",
    { class: "marks" },
    seconds("grasp", "Taken at", grasp),
    seconds("release", "put at", release),
    element(
      "label",
      { class: "check" },
      element("input", { ...whole, checked: said.whole ? "" : null }),
      "carried all the time",
    ),
    isMarked(said) && element("button", { type: "button", "data-unmark": id, "data-key": `unmark ${id}` }, "As found"),
  );
}

/** @param {ImportFile} file @param {FileReport} report @param {boolean} isOnly @param {ReaderName[]} readers */
function corrections({ id, choices }, report, isOnly, readers) {
  /** @type {[string, string][]} */
  const formats = [
    ["", `as found${report.format && `: ${report.format}`}`],
    ["mcap", "mcap: recording"],
  ];
  formats.push(...readers.map(({ name, title }) => /** @type {[string, string]} */ ([name, `${name}: ${title}`])));
  const all = element("button", { type: "button", "data-all": id, "data-key": `all ${id}` }, "Read all files so");
  return element(
    "details",
    { class: "corrections", "data-key": `corrections ${id}`, open: report.question ? "" : null },
    element("summary", {}, OTHER_READING),
    selectField(id, "format", "Format", formats, choices.format),
    selectField(id, "time", "Time", OPTIONS.time, choices.time),
    selectField(id, "units", "Lengths", OPTIONS.units, choices.units),
    selectField(id, "quaternion", "Quaternion", OPTIONS.quaternion, choices.quaternion),
    rateField(id, choices.rate),
    trackField(id, report.choices, choices.track),
    report.columns.length > 0 && columnFields(id, report.columns, choices.columns),
    !isOnly && element("p", { class: "buttons" }, all),
  );
}

/** @param {string} id @param {string[]} names that there are, if the reader tells @param {string} chosen */
function trackField(id, names, chosen) {
  if (!names.length) return textField(id, "track", FIELDS.track, chosen);
  const known = names.includes(chosen) || !chosen ? names : [chosen, ...names];
  const options = known.map((name) => /** @type {[string, string]} */ ([name, name]));
  return selectField(id, "track", FIELDS.track, [["", "none chosen"], ...options], chosen);
}

/** @param {string} id @param {string} field @param {string} name @param {[string, string][]} options @param {string} value */
function selectField(id, field, name, options, value) {
  const select = { id: `${field}-${id}`, "data-field": field, "data-file": id, "data-key": `${field} ${id}` };
  return element(
    "p",
    { class: "field" },
    element("label", { for: `${field}-${id}` }, name),
    element(
      "select",
      select,
      options.map(([key, text]) => chosenOption(key, text, key === value)),
    ),
  );
}

/** @param {string} id @param {string} field @param {string} name @param {string} value */
function textField(id, field, name, value) {
  const input = element("input", { type: "text", value, autocomplete: "off", ...fieldOf(id, field) });
  return element("p", { class: "field" }, element("label", { for: input.id }, name), input);
}

/** @param {string} id @param {number} rate [Hz]; 0: none is said */
function rateField(id, rate) {
  const input = numberInput({ min: 1, max: MAX_RATE, unit: "Hz", value: rate || "", ...fieldOf(id, "rate") });
  return element("p", { class: "field" }, element("label", { for: input.id }, "Rate [Hz]"), input);
}

/** @param {string} id @param {string} field */
const fieldOf = (id, field) => ({
  id: `${field}-${id}`,
  "data-field": field,
  "data-file": id,
  "data-key": `${field} ${id}`,
});

/** @param {string} id @param {string[]} columns @param {string} chosen */
function columnFields(id, columns, chosen) {
  const numbers = parseColumns(chosen);
  const fields = ROLES.map((role) => {
    const select = {
      "data-role": role,
      "data-file": id,
      "data-key": `${role} ${id}`,
      "aria-label": `Column of ${ROLE_NAMES[role] ?? role}`,
    };
    const options = columns.map((name, k) => chosenOption(String(k + 1), name, numbers[role] === String(k + 1)));
    return element("label", {}, ROLE_NAMES[role] ?? role, element("select", select, option("", "as found"), options));
  });
  return element("fieldset", { class: "columns" }, element("legend", {}, "Columns"), fields);
}

/** @param {string} value @param {string} text @param {boolean} isChosen */
const chosenOption = (value, text, isChosen) => element("option", { value, selected: isChosen ? "" : null }, text);

/**
 * The numbers of the columns by their roles, of a text as `t=1,x=3`.
 * @param {string} text
 * @returns {Record<string, string>}
 */
export const parseColumns = (text) =>
  Object.fromEntries(text.split(",").flatMap((part) => (part ? [part.split("=")] : [])));

/** The text of such numbers; roles without one are left out. @param {Record<string, string>} numbers */
export const formatColumns = (numbers) =>
  ROLES.flatMap((role) => (numbers[role] ? [`${role}=${numbers[role]}`] : [])).join(",");
