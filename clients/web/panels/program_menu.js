// Take it with you: a certified motion as a file of another program.
import { download, resourcePath } from "../api.js";
import { element, hint } from "../elements.js";

/** @type {[string, string][]} */
const FORMATS = [
  ["csv", "Table (CSV)"],
  ["mcap", "ROS 2 bag"],
  ["json", "ROS 2 JSON"],
  ["urscript", "URScript"],
  ["rapid", "RAPID"],
  ["krl", "KRL"],
  ["ls", "Fanuc LS"],
];
const PROGRAM_HELP =
  "The motion along the path, from rest to rest. The head of each file says what the certificate covers.";

/**
 * The menu of a plan's files; a refusal is shown like every other one.
 * @param {string} plan its id
 * @param {Context["attempt"]} attempt
 */
export function programMenu(plan, attempt) {
  const buttons = FORMATS.map(([format, name]) => {
    const button = element("button", { type: "button", "data-format": format }, name);
    const path = `${resourcePath("plans", plan, "program")}?format=${format}`;
    button.addEventListener("click", () => attempt(() => download(path)));
    return button;
  });
  const title = element("summary", {}, "Take it with you");
  return element("details", {}, title, hint(PROGRAM_HELP), element("p", { class: "buttons" }, buttons));
}
