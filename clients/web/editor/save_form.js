// Saving the draft as a version. When somebody saved a newer one meanwhile, the operator chooses; no edit is lost.
import { ApiError, post, resourcePath } from "../api.js";
import { block, element } from "../elements.js";
import { icon } from "../icons.js";
import { conflictDialog } from "./conflict_dialog.js";
import { versionTitle } from "./versions.js";

const FORM = "edit-form";
const AUTHOR_KEY = "operator"; // who works at this browser, also for control of the arm

/** @typedef {Record<"name" | "author" | "note" | "branch", HTMLInputElement>} Fields */

/** @param {HTMLElement} place @param {Editor} editor @param {HTMLElement} foot where its button goes @returns {EditorSection} */
export function saveForm(place, editor, foot) {
  const fields = createFields();
  const labels = Object.entries({ name: "Name of the version", author: "Author", note: "Note", branch: "Branch" });
  const save = element(
    "button",
    { type: "submit", id: "edit-save", form: FORM, class: "primary" },
    icon("save"),
    "Save version",
  );
  const status = element("p", { class: "note", id: "edit-unsaved" });
  const form = element(
    "form",
    { class: "saving", id: FORM },
    labels.map(([name, label]) => element("label", {}, label, fields[/** @type {keyof Fields} */ (name)])),
  );
  place.append(status, form);
  foot.append(save);
  const ask = conflictDialog(editor);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    localStorage.setItem(AUTHOR_KEY, fields.author.value);
    const { draft } = editor;
    if (draft) editor.context.attempt(() => saveVersion(editor, draft, fields, fields.branch.value, ask));
  });
  let filled = { path: "", branch: "" }; // for which path, and with what, the branch was filled in

  return {
    update(editor, what) {
      const { draft } = editor;
      if (!draft || what === "drag" || what === "feasibility") return;
      const { path, base } = draft;
      if (what === "draft") {
        if (filled.path !== path || fields.branch.value === filled.branch) fields.branch.value = base.branch;
        filled = { path, branch: base.branch };
      }
      block(save, draft.edited || fields.branch.value !== base.branch ? "" : "Nothing was edited since this version.");
      status.textContent = statusText(draft, editor.versions);
    },
  };
}

/** @returns {Fields} */
function createFields() {
  /** @param {string} id @param {number} length */
  const text = (id, length) =>
    element("input", { type: "text", id: `edit-${id}`, maxlength: length, autocomplete: "off" });
  const [name, author, note, branch] = [text("name", 80), text("author", 80), text("note", 2000), text("branch", 64)];
  author.value = localStorage.getItem(AUTHOR_KEY) ?? "";
  return { name, author, note, branch };
}

/** @param {import("./draft.js").Draft} draft @param {Version[]} versions */
function statusText({ base, edited }, versions) {
  const newer = versions.findLast((version) => version.branch === base.branch && version.number > base.number);
  const behind =
    newer && ` Version ${versionTitle(newer)} was saved meanwhile${newer.author && ` by ${newer.author}`}.`;
  const title = versionTitle(base);
  const now = edited
    ? `Edited since version ${title}; kept in this tab until it is saved.`
    : `This is version ${title}.`;
  return `${now}${behind ?? ""}`;
}

/**
 * Save a draft. Whatever is typed, edited or opened while the service saves is left as it is.
 * @param {Editor} editor
 * @param {import("./draft.js").Draft} draft
 * @param {Fields} fields
 * @param {string} branch
 * @param {import("./conflict_dialog.js").AskConflict} ask
 * @returns {Promise<void>}
 */
async function saveVersion(editor, draft, fields, branch, ask) {
  const { curve, base } = draft;
  const [name, author, note] = [fields.name.value, fields.author.value, fields.note.value];
  const version = { base: base.number, curve, branch, name, author, note };
  /** @type {Version} */
  let saved;
  try {
    saved = await post(resourcePath("paths", draft.path, "versions"), version);
  } catch (error) {
    if (!(error instanceof ApiError && error.kind === "Outdated")) throw error;
    const choice = await ask(error, `${author || "edit"}-${base.number}`);
    if (choice.branch) await saveVersion(editor, draft, fields, choice.branch, ask);
    else if (choice.theirs && error.newer) await editor.loadVersion(error.newer.number, draft);
    return editor.readVersions();
  }
  draft.saved(saved, curve);
  if (fields.name.value === name) fields.name.value = "";
  if (fields.note.value === note) fields.note.value = "";
  await editor.readVersions();
  if (draft !== editor.draft) return;
  editor.refresh();
  editor.context.messages.show(`Saved as version ${versionTitle(saved)} on branch ${saved.branch}.`);
}
