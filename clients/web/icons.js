// The drawings on buttons: 24 by 24, in the colour of the text, and nothing to a screen reader, which reads the text.
import { svgElement } from "./elements.js";

/** Outlines, and after a bar what is filled. @type {Record<string, string>} */
const DRAWINGS = {
  start: "|M7 4.5v15l12-7.5z",
  hold: "M8 5v14M16 5v14",
  resume: "M5 5v14|M10 5v14l10-7z",
  stop: "|M6 6h12v12H6z",
  back: "M15 5l-8 7 8 7",
  ahead: "M9 5l8 7-8 7",
  reverse: "M9 5L4 10l5 5M4 10h10a5 5 0 0 1 0 10h-3",
  preview: "M2 12s4-6 10-6 10 6 10 6-4 6-10 6S2 12 2 12zM12 9.5a2.5 2.5 0 1 0 .01 0",
  show: "M8 12V5.5a1.5 1.5 0 0 1 3 0V11m0-1.5a1.5 1.5 0 0 1 3 0V12m0-1a1.5 1.5 0 0 1 3 0v4a6 6 0 0 1-6 6 6 6 0 0 1-5-3l-3-5a1.5 1.5 0 0 1 2.5-1.5L8 13",
  learn: "M4 19c4 0 4-14 9-14h7M4 19c5 0 6-6 16-6M17 2l3 3-3 3M17 10l3 3-3 3",
  certify: "M12 3l8 3v6c0 5-4 8-8 9-4-1-8-4-8-9V6zM8.5 12l2.5 2.5 4.5-5",
  edit: "M4 20l1-5L16 4l4 4L9 19zM13.5 6.5l4 4",
  undo: "M8 5L4 9l4 4M4 9h10a5 5 0 0 1 0 10H9",
  redo: "M16 5l4 4-4 4M20 9H10a5 5 0 0 0 0 10h5",
  save: "M5 4h11l3 3v13H5zM8 4v5h7V4M8 20v-6h8v6",
  home: "M4 11l8-7 8 7M6 10v10h12V10",
};

/** @param {string} name of a drawing */
export function icon(name) {
  const [outline, filled] = DRAWINGS[name].split("|");
  const attributes = { class: "icon", viewBox: "0 0 24 24", "aria-hidden": "true" };
  return svgElement(
    "svg",
    attributes,
    outline && svgElement("path", { d: outline }),
    filled && svgElement("path", { d: filled, class: "filled" }),
  );
}
