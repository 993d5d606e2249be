// The dialog for the second of two who edit one path: both may be kept, or the other's version be taken.
import { element } from "../elements.js";
import { capitalize } from "../texts.js";

/**
 * What the operator chose: save on a branch, go on from the other's version, or nothing yet.
 * @typedef {{branch?: string, theirs?: boolean}} ConflictChoice
 *
 * @typedef {(refusal: import("../api.js").ApiError, branch: string) => Promise<ConflictChoice>} AskConflict `branch`: proposed
 */

/**
 * Returns what opens the dialog.
 * @param {Editor} editor
 * @returns {AskConflict}
 */
export function conflictDialog(editor) {
  const status = element("p", { id: "conflict-status" });
  const name = element("input", { type: "text", id: "conflict-branch", maxlength: "64", autocomplete: "off" });
  const dialog = createDialog(status, name);
  document.body.append(dialog);
  return ({ message, newer }, branch) =>
    new Promise((resolve) => {
      status.textContent = `${capitalize(message)}.${newer?.note ? ` Note: ${newer.note}` : ""}`;
      name.value = branch;
      dialog.returnValue = "";
      const choose = () => {
        if (dialog.returnValue === "mine") resolve({ branch: name.value.trim() || branch });
        else resolve({ theirs: dialog.returnValue === "theirs" });
      };
      dialog.addEventListener("close", choose, { once: true });
      dialog.showModal();
      editor.readVersions();
    });
}

/** @param {HTMLElement} status @param {HTMLInputElement} name */
function createDialog(status, name) {
  /** @param {string} value @param {string} text @param {string} className */
  const button = (value, text, className = "") => element("button", { type: "submit", value, class: className }, text);
  const keepBoth = element("label", {}, "Keep both: save mine on the branch", name);
  const takeTheirs = element("p", {}, "Go on from theirs; undo brings my edit back.");
  const later = element("p", {}, "Save nothing yet; my edit stays in this tab.");
  return element(
    "dialog",
    { id: "conflict", "aria-labelledby": "conflict-title", "aria-describedby": "conflict-status" },
    element(
      "form",
      { method: "dialog" },
      element("h2", { id: "conflict-title" }, "Somebody saved a newer version"),
      status,
      element("div", { class: "choice" }, keepBoth, button("mine", "Save on a branch", "primary")),
      element("div", { class: "choice" }, takeTheirs, button("theirs", "Take theirs")),
      element("div", { class: "choice" }, later, button("", "Not now")),
    ),
  );
}
