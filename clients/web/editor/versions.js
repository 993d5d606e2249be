// The versions of the path: which there are, which one is edited, and how two of them differ.
import { get, resourcePath } from "../api.js";
import { block, closestData, element, option } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { readVersion } from "./stored_versions.js";

/** @param {HTMLElement} place @param {Editor} editor @returns {EditorSection} */
export function versionsSection(place, editor) {
  const table = element("div", { class: "versions" });
  const [first, second] = ["first", "second"].map((id) =>
    element("select", { id: `edit-${id}`, "aria-label": `${id} version to compare` }),
  );
  const compare = element("button", { type: "button", id: "edit-compare" }, "Compare");
  const status = element("p", { class: "note", id: "edit-difference", role: "status" });
  place.append(table, element("div", { class: "row compare" }, first, " with ", second, compare), status);
  table.addEventListener("click", (event) => {
    const { version: number } = closestData(event);
    if (number) editor.context.attempt(() => editor.loadVersion(Number(number)));
  });
  let turn = 0; // the newest comparison is the one that is shown
  const difference = () => {
    const mine = ++turn;
    return compareVersions(editor, Number(first.value), Number(second.value), status, () => mine === turn);
  };
  compare.addEventListener("click", () => editor.context.attempt(difference));
  /** @type {Map<HTMLSelectElement, string>} */
  const chosen = new Map(); // select -> number of a version, as a person chose it
  for (const select of [first, second]) select.addEventListener("change", () => chosen.set(select, select.value));
  let path = "";

  return {
    update(editor, what) {
      const { draft } = editor;
      if (!draft || !["draft", "curve", "versions"].includes(what)) return;
      if (draft.path !== path) {
        path = draft.path;
        chosen.clear();
      }
      if (what === "draft") {
        turn += 1;
        editor.curveOverlay.setComparison(null, null);
        status.textContent = "";
      }
      patchChildren(table, content(editor));
      const numbers = editor.versions.map(({ number }) => String(number));
      const usual = ["1", numbers[numbers.length - 1]];
      for (const [i, select] of [first, second].entries()) {
        select.replaceChildren(...editor.versions.map((version) => option(version.number, versionTitle(version))));
        select.value = chosen.get(select) ?? usual[i];
      }
      block(compare, numbers.length < 2 ? "There is one version only." : "");
    },
  };
}

/** @param {Pick<Version, "number" | "name">} version */
export const versionTitle = ({ number, name }) => (name ? `${number} ${name}` : `${number}`);

/** @param {Editor} editor */
function content({ draft, versions }) {
  const head = element(
    "thead",
    {},
    element(
      "tr",
      {},
      ["", "Version", "Branch", "Saved", ""].map((text) =>
        element(text ? "th" : "td", text ? { scope: "col" } : {}, text),
      ),
    ),
  );
  const rows = versions.toReversed().map((version) => {
    const here = version.number === draft?.base.number;
    return element(
      "tr",
      { class: here ? "selected" : "", title: version.note || false },
      element("td", {}, here && element("span", { class: "tick", role: "img", "aria-label": "edited now" }, "✎")),
      element("td", {}, versionTitle(version), version.parent && element("small", {}, ` from ${version.parent}`)),
      element("td", {}, version.branch),
      element("td", {}, [version.author, when(version.created_ns)].filter(Boolean).join(", ")),
      element(
        "td",
        {},
        element(
          "button",
          {
            type: "button",
            "data-version": String(version.number),
            "data-key": `take-${version.number}`,
            "aria-label": `edit version ${version.number}`,
          },
          "Edit",
        ),
      ),
    );
  });
  return element("table", {}, head, element("tbody", {}, rows));
}

/**
 * Show two versions side by side and say how they differ.
 * @param {Editor} editor
 * @param {number} a
 * @param {number} b
 * @param {HTMLElement} status
 * @param {() => boolean} newest whether no other comparison was asked for meanwhile
 */
async function compareVersions(editor, a, b, status, newest) {
  const { path = "" } = editor.draft ?? {};
  const [difference, one, other] = await Promise.all([
    get(resourcePath("paths", path, "versions", a, "difference", b)),
    readVersion(path, a),
    readVersion(path, b),
  ]);
  if (path !== editor.draft?.path || !newest()) return;
  editor.curveOverlay.setComparison(one.path.curve, other.path.curve);
  status.textContent = `Version ${a} (orange) and version ${b} (pink): ${difference.sentence}.`;
  status.scrollIntoView({ block: "nearest" });
}

/** @param {number} ns since the Unix epoch */
function when(ns) {
  const date = new Date(ns / 1e6);
  const today = date.toDateString() === new Date().toDateString();
  return date.toLocaleString(
    "en-GB",
    today
      ? { hour: "2-digit", minute: "2-digit" }
      : { day: "numeric", month: "short", hour: "2-digit", minute: "2-digit" },
  );
}
