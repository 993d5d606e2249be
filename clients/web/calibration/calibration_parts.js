// What the guided calibration is made of, and what it says.
import { element, hint, option } from "../elements.js";
import { numberInput } from "../number_input.js";
import { MAX_LENGTH } from "../scenes/shape_fields.js";

export const MIN_POINTS = 3;
const NAME_LENGTH = 64;

/** @typedef {"tracker" | "table" | "shape"} Aim */

/** What each aim is, for who chooses. @type {Record<Aim, string>} */
const AIMS = {
  tracker: "the frame of a tracker",
  table: "the scene to the arm's base",
  shape: "the chosen shape, by three points",
};

/** @type {Record<Aim, string>} */
export const ABOUT_AIM = {
  tracker:
    "Hold the tracker still at places whose numbers are known, the corners of the table for instance: three or more, far apart and not on one line.",
  table:
    "Move the arm so that its tool's point touches places of the scene, the corners of the table for instance: three or more, far apart and not on one line. Then all that stands in the scene is moved to where the arm found it; the floor stays.",
  shape: "Touch three points of the shape that is chosen above; it is put where they say.",
};

export function calibrationParts() {
  /** @param {string} text @param {string} id */
  const button = (text, id) => element("button", { type: "button", id: `calibration-${id}` }, text);
  /** @param {HTMLElement} input @param {string} text */
  const field = (input, text) => element("p", { class: "field" }, element("label", { for: input.id }, text), input);
  const aims = Object.entries(AIMS).map(([aim, text]) => option(aim, text));
  const aim = element("select", { id: "calibration-aim" }, aims);
  const device = element("select", { id: "calibration-device" });
  const frame = element("select", { id: "calibration-frame" });
  const name = element("input", { type: "text", id: "calibration-name", maxlength: NAME_LENGTH, autocomplete: "off" });
  const place = ["x", "y", "z"].map((axis) =>
    numberInput({ id: `calibration-${axis}`, min: -MAX_LENGTH, max: MAX_LENGTH, unit: "mm" }),
  );
  const labels = place.map((input, k) => element("label", {}, `${"xyz"[k]} (mm)`, input));
  const places = element("div", { class: "fields thirds" }, labels);
  const [touched, again] = [button("Touched: measure it", "touch"), button("Take the last point back", "back")];
  const [trial, keep] = [button("Try it: touch any place", "try"), button("Keep", "keep")];
  keep.className = "primary";
  const about = hint("");
  const next = element("p", { class: "verdict-line", role: "status", id: "calibration-next" });
  const points = element("ol", { id: "calibration-points" });
  const verdict = element("p", { class: "note", role: "status", id: "calibration-verdict" });
  const frameField = field(frame, "Its calibration");
  const nameField = field(name, "Keep as");
  const all = [
    field(aim, "Find"),
    about,
    field(device, "Touch with"),
    frameField,
    next,
    places,
    element("p", { class: "buttons" }, touched, again),
    points,
    verdict,
    nameField,
    element("p", { class: "buttons" }, trial, keep),
  ];
  const fields = { frameField, nameField, places };
  return { all, ...fields, aim, device, frame, name, place, touched, again, trial, keep, about, next, points, verdict };
}

/** A place in millimetres. @param {number[]} place [m] */
export const placeText = (place) => `${place.map((metres) => (1000 * metres).toFixed(1)).join(", ")} mm`;

/** A length in millimetres. @param {number} metres */
export const lengthText = (metres) => `${(1000 * metres).toFixed(1)} mm`;
