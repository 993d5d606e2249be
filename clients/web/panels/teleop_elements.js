// What the panel of a live hand is made of, and what it says.
import { definitionList, element, hint, option } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { capitalize } from "../texts.js";

export const PAGE_HAND = "this page";
export const HEADSET = "a headset";

/** @type {Fact[]} */
const HELP = [
  ["Mouse, touch", "press on the ball at the gripper and drag; shift, the wheel or a second finger change the height"],
  ["Keyboard", "hold Enter; arrows, Page Up and Page Down move"],
  ["Gamepad", "hold A; left stick moves, right stick changes the height"],
  ["Gripper", "G, or the button, while the clutch is held"],
  ["Headset", "the right hand leads, its pinch or trigger closes the gripper; the left one's is the clutch"],
];
const TELEOP_HELP =
  "Move the arm by hand, without a path: it follows while the clutch is held, and rests when it is let go.";

/**
 * What gives way near joint limits and singular poses, by orientation.
 * @type {Record<string, string>}
 */
const ORIENTATION_RULES = {
  "": "What gives way where the arm can't follow is said while it does.",
  keep: "Where the arm can't keep it, the tool stays short of the hand; that is said while it does.",
  follow: "Where the arm can't turn so far, the tool turns less first, then stays short; that is said while it does.",
};

export function createElements() {
  /** @param {string} text @param {import("../elements.js").Attributes} attributes */
  const button = (text, attributes = {}) => element("button", { type: "button", ...attributes }, text);
  /** @param {HTMLElement} input @param {string} text */
  const field = (input, text) => element("p", { class: "field" }, element("label", { for: input.id }, text), input);
  const hand = element("select", { id: "teleop-hand" }, option(PAGE_HAND));
  const calibration = element("select", { id: "teleop-calibration" }, option("identity"));
  const calibrationField = field(calibration, "Calibration");
  const begin = button("Lead the arm", { class: "primary" });
  const orientation = element(
    "select",
    { id: "teleop-orientation", "aria-describedby": "teleop-orientation-rule" },
    option("", "as the station is set"),
    option("keep", "keeps its orientation"),
    option("follow", "turns with the hand"),
  );
  const rule = element("p", { class: "note", id: "teleop-orientation-rule" }, ORIENTATION_RULES[""]);
  orientation.addEventListener("change", () => {
    rule.textContent = ORIENTATION_RULES[orientation.value];
  });
  const beginRow = element("p", { class: "buttons" }, begin);
  const fields = [field(hand, "Hand"), calibrationField, field(orientation, "Tool"), rule];
  const idle = element("div", {}, hint(TELEOP_HELP), fields, beginRow);
  const statusText = element("p", { class: "session-status", role: "status" });
  const held = { class: "primary hold", "aria-pressed": "false", title: "Or hold Enter" };
  const clutch = button("Clutch: hold to move the arm", held);
  const [grip, finish] = [button("Close the gripper"), button("Finish")];
  const help = element("details", {}, element("summary", {}, "How to lead the arm"), definitionList(HELP));
  const clutchRow = element("p", { class: "buttons" }, clutch);
  const active = element(
    "div",
    { hidden: "" },
    statusText,
    clutchRow,
    element("p", { class: "buttons" }, grip, finish),
    help,
  );
  const idleParts = { idle, hand, calibration, calibrationField, orientation, begin };
  return { all: [idle, active], ...idleParts, active, statusText, clutch, grip, finish };
}

/**
 * Offer other names; what is chosen stays chosen while it is there, else it is the first.
 * @param {HTMLSelectElement} select
 * @param {string[]} names
 */
export function refill(select, names) {
  const chosen = select.value;
  patchChildren(
    select,
    names.map((name) => option(name)),
  );
  select.value = names.includes(chosen) ? chosen : names[0];
}

/**
 * What is said of an arm that follows a hand.
 * @param {ExecutorStatus} status
 * @param {import("../hand/teleop_session.js").TeleopSession} session
 */
export function teleopText(status, { usesPageHand, usesHeadset }) {
  const hindrance = status.hindrance && capitalize(status.hindrance);
  const scene = status.hand_scene && ` in scene ${status.hand_scene}`;
  if (status.state === "following") return `The arm follows${scene}.${hindrance && ` ${hindrance}.`}`;
  if (status.state === "stopping") return "Let go: the arm comes to rest.";
  if (hindrance) return `The arm is held. ${hindrance}.`;
  if (!status.awaits_clutch) return `The arm is held: ${status.reason}.`;
  const held = `The arm is held${scene}.`;
  if (usesHeadset) return `${held} Close the left hand, and it follows the right one.`;
  return usesPageHand
    ? `${held} Press on the ball at the gripper and drag it, or hold the clutch.`
    : `${held} Hold the clutch, and it follows the hand.`;
}
