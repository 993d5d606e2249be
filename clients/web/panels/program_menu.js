// Take it with you: a motion as a file of another program.
import { download, resourcePath } from "../api.js";
import { element, hint } from "../elements.js";

/** @type {[string, string][]} */
const RECORD_FORMATS = [
  ["csv", "Table (CSV)"],
  ["mcap", "ROS 2 bag"],
  ["json", "ROS 2 JSON"],
];
/** @type {[string, string][]} */
const ROBOT_FORMATS = [
  ["urscript", "URScript"],
  ["rapid", "RAPID"],
  ["krl", "KRL"],
  ["ls", "Fanuc LS"],
];
const PLAN_HELP =
  "The motion along the path, from rest to rest. The head of each file says what the certificate covers.";
const EXECUTION_HELP =
  "What the arm was sent. A recording has no certificate: programs of controllers are made of the plan.";

/**
 * The menu of a plan's files; a refusal is shown like every other one.
 * @param {string} plan its id
 * @param {Context["attempt"]} attempt
 */
export function planMenu(plan, attempt) {
  return menu(resourcePath("plans", plan, "program"), [...RECORD_FORMATS, ...ROBOT_FORMATS], PLAN_HELP, attempt);
}

/**
 * The menu of an execution's files, likewise; one that has not ended is refused.
 * @param {string} execution its id
 * @param {Context["attempt"]} attempt
 */
export function executionMenu(execution, attempt) {
  return menu(resourcePath("executions", execution, "program"), RECORD_FORMATS, EXECUTION_HELP, attempt);
}

/**
 * @param {string} path of the files
 * @param {[string, string][]} formats
 * @param {string} help
 * @param {Context["attempt"]} attempt
 */
function menu(path, formats, help, attempt) {
  const buttons = formats.map(([format, name]) => {
    const button = element("button", { type: "button", "data-format": format }, name);
    button.addEventListener("click", () => attempt(() => download(`${path}?format=${format}`)));
    return button;
  });
  const title = element("summary", {}, "Take it with you");
  return element("details", {}, title, hint(help), element("p", { class: "buttons" }, buttons));
}
