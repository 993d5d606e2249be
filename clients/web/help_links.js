// Links to the documents: from the header, and from each panel to those that fit it; there are none where no site was built.
import { element } from "./elements.js";

/** Documents that fit the panels: their files in docs, and what is said of them. @type {Record<string, [file: string, text: string][]>} */
export const DOCUMENTS = {
  demonstrate: [
    ["tutorial", "First path"],
    ["your-tracker", "Trackers"],
    ["import", "Files"],
  ],
  ways: [["consistency", "How the ways are told apart"]],
  edit: [["certificate", "What a certificate proves"]],
  scene: [["scenes", "Scenes from files"]],
  run: [
    ["live-hand", "Live hand"],
    ["real-arm", "Real arms"],
    ["timing", "How motions are timed"],
  ],
};

/** @param {string} file of the site @param {string} text */
export const helpLink = (file, text) =>
  element("a", { href: `help/${file}.html`, target: "_blank", rel: "noopener" }, text);

/** The links of a panel, hidden until the station has said that there are documents. @param {string} panel */
export function panelHelp(panel) {
  const links = (DOCUMENTS[panel] ?? []).map(([file, text]) => helpLink(file, text));
  return element(
    "p",
    { class: "help", hidden: "" },
    "Help: ",
    links.flatMap((link, k) => (k ? [" · ", link] : [link])),
  );
}
