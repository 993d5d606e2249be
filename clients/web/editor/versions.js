// The versions of the path: which there are, which one is edited, and how two of them differ.
import { get, resourcePath } from "../api.js";
import { element, patchChildren } from "../elements.js";

export function versionsSection(place, editor) {
  const table = element("div", { class: "versions" });
  const [first, second] = ["first", "second"].map((id) =>
    element("select", { id: `edit-${id}`, "aria-label": `${id} version to compare` }),
  );
  const compare = element("button", { type: "button", id: "edit-compare" }, "Compare");
  const status = element("p", { class: "note", id: "edit-difference", role: "status" });
  place.append(table, element("div", { class: "row compare" }, first, " with ", second, compare), status);
  table.addEventListener("click", (event) => {
    const number = event.target.closest("button")?.dataset.version;
    if (number) editor.context.attempt(() => editor.loadVersion(Number(number)));
  });
  let turn = 0; // the newest comparison is the one that is shown
  const difference = () => {
    const mine = ++turn;
    return compareVersions(editor, Number(first.value), Number(second.value), status, () => mine === turn);
  };
  compare.addEventListener("click", () => editor.context.attempt(difference));
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
      for (const [select, usual] of [
        [first, "1"],
        [second, numbers.at(-1)],
      ]) {
        select.replaceChildren(
          ...editor.versions.map((version) =>
            element("option", { value: String(version.number) }, versionTitle(version)),
          ),
        );
        select.value = chosen.get(select) ?? usual;
      }
      compare.disabled = numbers.length < 2;
    },
  };
}

export const versionTitle = ({ number, name }) => (name ? `${number} ${name}` : `${number}`);

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
    const here = version.number === draft.base.number;
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

async function compareVersions(editor, a, b, status, newest) {
  const { path } = editor.draft;
  const read = (number) => get(resourcePath("paths", path, "versions", number));
  const [difference, one, other] = await Promise.all([
    get(resourcePath("paths", path, "versions", a, "difference", b)),
    read(a),
    read(b),
  ]);
  if (path !== editor.draft?.path || !newest()) return;
  editor.curveOverlay.setComparison(one.path.curve, other.path.curve);
  status.textContent = `Version ${a} (orange) and version ${b} (pink): ${difference.sentence}.`;
  status.scrollIntoView({ block: "nearest" });
}

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
