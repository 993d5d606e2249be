// The versions of a scene: who saved which when and why, and the way back to each.
import { blocked, element } from "../elements.js";
import { formatMoment } from "../texts.js";

/** @param {SceneVersion[]} versions newest first @param {number} base number of the one that is edited */
export function sceneVersions(versions, base) {
  const rows = versions.map((version) => row(version, version.number === base));
  return element("ul", { class: "access", "aria-label": "versions of the scene" }, rows);
}

/** @param {SceneVersion} version @param {boolean} isBase */
function row({ number, created_ns, author, note, removed }, isBase) {
  const when = created_ns ? formatMoment(created_ns) : "of the settings";
  const said = [when, author, removed && "removed then", note].filter(Boolean).join(", ");
  const why = isBase ? "It is the one that is edited: Back to the version undoes what was changed." : "";
  return element(
    "li",
    { "data-key": `version ${number}` },
    element("span", {}, element("b", {}, `Version ${number}`), ` ${said}`),
    element(
      "button",
      { type: "button", "data-version": number, "aria-label": `take version ${number}`, ...blocked(why) },
      "Take it",
    ),
  );
}
