// Saving the draft as a version. When somebody saved a newer one meanwhile, the operator chooses; no edit is lost.
import { post, resourcePath } from "../api.js";
import { element } from "../elements.js";
import { versionTitle } from "./versions.js";

const AUTHOR_KEY = "operator"; // who works at this browser, also for control of the arm
const LABELS = { name: "Name of the version", author: "Author", note: "Note", branch: "Branch" };

export function saveForm(place, editor) {
  const text = (id, length) =>
    element("input", { type: "text", id: `edit-${id}`, maxlength: length, autocomplete: "off" });
  const fields = {
    name: text("name", "80"),
    author: text("author", "80"),
    note: text("note", "2000"),
    branch: text("branch", "64"),
  };
  const labels = Object.entries(LABELS).map(([name, label]) => element("label", {}, label, fields[name]));
  fields.author.value = localStorage.getItem(AUTHOR_KEY) ?? "";
  const save = element("button", { type: "submit", id: "edit-save", class: "primary" }, "Save version");
  const status = element("p", { class: "note", id: "edit-unsaved" });
  const form = element("form", { class: "saving" }, labels, save);
  place.append(status, form);
  const ask = conflictDialog(editor);
  form.addEventListener("submit", (event) => {
    event.preventDefault();
    localStorage.setItem(AUTHOR_KEY, fields.author.value);
    editor.context.attempt(() => saveVersion(editor, editor.draft, fields, fields.branch.value, ask));
  });
  let filled = null; // {path, branch}: for which path, and with what, the field was filled in

  return {
    update(editor, what) {
      const { draft } = editor;
      if (!draft || what === "drag" || what === "feasibility") return;
      const {
        path,
        base: { branch },
      } = draft;
      if (what === "draft" && (filled?.path !== path || fields.branch.value === filled.branch))
        fields.branch.value = branch;
      if (what === "draft") filled = { path, branch };
      save.disabled = !draft.edited && fields.branch.value === draft.base.branch;
      const newer = editor.versions.findLast((version) => version.branch === draft.base.branch);
      const behind =
        newer && newer.number > draft.base.number
          ? ` Version ${versionTitle(newer)} was saved meanwhile${newer.author && ` by ${newer.author}`}.`
          : "";
      status.textContent =
        (draft.edited
          ? `Edited since version ${versionTitle(draft.base)}; kept in this tab until it is saved.`
          : `This is version ${versionTitle(draft.base)}.`) + behind;
    },
  };
}

// Whatever is typed, edited or opened while the service saves is left as it is.
async function saveVersion(editor, draft, fields, branch, ask) {
  const { curve } = draft;
  const words = Object.fromEntries(["name", "author", "note"].map((name) => [name, fields[name].value]));
  let saved;
  try {
    saved = await post(resourcePath("paths", draft.path, "versions"), {
      base: draft.base.number,
      curve,
      branch,
      ...words,
    });
  } catch (error) {
    if (error.kind !== "Outdated") throw error;
    const choice = await ask(error, `${words.author || "edit"}-${draft.base.number}`);
    if (choice.branch) await saveVersion(editor, draft, fields, choice.branch, ask);
    else if (choice.theirs) await editor.loadVersion(error.newer.number, draft);
    return editor.readVersions();
  }
  draft.saved(saved, curve);
  for (const name of ["name", "note"]) if (fields[name].value === words[name]) fields[name].value = "";
  await editor.readVersions();
  if (draft !== editor.draft) return;
  editor.refresh();
  editor.context.messages.show(`Saved as version ${versionTitle(saved)} on branch ${saved.branch}.`);
}

// The dialog for the second of two: `ask(refusal, branch)` resolves to {branch}, {theirs: true} or {}.
function conflictDialog(editor) {
  const status = element("p", { id: "conflict-status" });
  const name = element("input", { type: "text", id: "conflict-branch", maxlength: "64", autocomplete: "off" });
  const button = (value, words, primary) =>
    element("button", { type: "submit", value, class: primary && "primary" }, words);
  const dialog = element(
    "dialog",
    { id: "conflict", "aria-labelledby": "conflict-title", "aria-describedby": "conflict-status" },
    element(
      "form",
      { method: "dialog" },
      element("h2", { id: "conflict-title" }, "Somebody saved a newer version"),
      status,
      element(
        "div",
        { class: "choice" },
        element("label", {}, "Keep both: save mine on the branch", name),
        button("mine", "Save on a branch", true),
      ),
      element(
        "div",
        { class: "choice" },
        element("p", {}, "Go on from theirs; undo brings my edit back."),
        button("theirs", "Take theirs"),
      ),
      element(
        "div",
        { class: "choice" },
        element("p", {}, "Save nothing yet; my edit stays in this tab."),
        button("", "Not now"),
      ),
    ),
  );
  document.body.append(dialog);
  return (refusal, branch) =>
    new Promise((resolve) => {
      const { newer } = refusal;
      status.textContent = `${refusal.message[0].toUpperCase()}${refusal.message.slice(1)}.${newer.note ? ` Note: ${newer.note}` : ""}`;
      name.value = branch;
      dialog.returnValue = "";
      dialog.addEventListener(
        "close",
        () =>
          resolve(
            { mine: { branch: name.value.trim() || branch }, theirs: { theirs: true } }[dialog.returnValue] ?? {},
          ),
        { once: true },
      );
      dialog.showModal();
      editor.readVersions();
    });
}
