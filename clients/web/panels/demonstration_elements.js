// What the panel of a demonstration session is made of, and how it shows a session.
import { blocked, definitionList, element, hint, option } from "../elements.js";
import { icon } from "../icons.js";
import { capitalize, formatNumber } from "../texts.js";

/** @type {Record<string, string>} */
const PHASE_TEXTS = {
  countdown: "Get ready …",
  ready: "Press on the object, carry it to its goal and let go.",
  carrying: "Carrying. Let go at the goal.",
  judging: "Let go. Waiting for the recorder …",
  returning: "The object goes back to its start.",
  lost: "The connection broke off; what was carried is lost. Connecting again …",
};

/** @type {Fact[]} */
const HELP = [
  ["Mouse", "press and drag; shift or the wheel changes the height"],
  ["Touch", "one finger drags, a second one changes the height"],
  ["Keyboard", "Enter grasps and lets go; arrows, Page Up, Page Down"],
  ["Gamepad", "hold A; left stick moves, right stick changes the height"],
];
const DEMONSTRATION_HELP = "No glove? Carry the object in the view yourself; the recorder takes it like any tracker.";

export function createElements() {
  /** @param {string} text @param {import("../elements.js").Attributes} attributes */
  const button = (text, attributes = {}) => element("button", { type: "button", ...attributes }, text);
  const start = button("Show it here", { class: "primary" });
  start.prepend(icon("show"));
  const headset = button("In a headset", blocked("It is not known yet whether there is a headset."));
  const why = element("p", { class: "note" });
  const name = element("input", { type: "text", id: "task-name", value: "first-task", autocomplete: "off" });
  const nameField = element("p", { class: "field" }, element("label", { for: "task-name" }, "Name of the task"), name);
  const seconds = element("select", { id: "countdown" }, option(0, "none"), option(3, "3 s"), option(5, "5 s"));
  seconds.value = "3";
  const countdown = element("p", { class: "field" }, element("label", { for: "countdown" }, "Countdown"), seconds);
  const next = element("div", {}); // what can be done with what was shown
  const idle = element(
    "div",
    {},
    hint(DEMONSTRATION_HELP),
    nameField,
    countdown,
    element("p", { class: "buttons" }, start, headset),
    next,
    why,
  );
  const statusText = element("p", { class: "session-status", role: "status" });
  const list = { class: "demonstration-list", "aria-label": "demonstrations of this session" };
  const demonstrations = element("ol", list);
  const [discard, undo, finish] = [button("Discard the take"), button("Undo"), button("Finish", { class: "primary" })];
  const figures = element("div", {});
  const buttons = element("p", { class: "buttons" }, finish, discard, undo);
  const active = element("div", { hidden: "" }, statusText, demonstrations, buttons, figures);
  const help = element("details", {}, element("summary", {}, "How to carry the object"), definitionList(HELP));
  const idleParts = { idle, start, headset, next, why, name, nameField, seconds };
  return {
    all: [idle, active, help],
    ...idleParts,
    active,
    statusText,
    demonstrations,
    discard,
    undo,
    finish,
    figures,
  };
}

/**
 * What is said of a session.
 * @param {import("../hand/demonstration_session.js").DemonstrationSession} session
 */
export function sessionText({ phase, note, demonstrations, handModel }) {
  if (phase === "carrying") {
    const obstacle = handModel.collidingObstacle(handModel.position);
    return obstacle ? `The object is in the ${obstacle}.` : PHASE_TEXTS.carrying;
  }
  const last = demonstrations.at(-1);
  const outcome = note || (last && `Take ${last.number}: ${last.verdict}.`) || "";
  return `${outcome} ${PHASE_TEXTS[phase]}`.trim();
}

/** @param {import("../hand/sample_sender.js").SampleSender} sender */
export function senderFacts({ offset, dropped, sequence }) {
  const clock = offset && `${formatNumber(offset.ms, 1, "ms")} off, ± ${formatNumber(offset.within, 1, "ms")}`;
  return definitionList([
    ["Samples sent", formatNumber(sequence - dropped, 0)],
    ["Left out", dropped > 0 && formatNumber(dropped, 0)],
    ["Clock", clock],
  ]);
}

/**
 * Why a demonstration is as it is: for the operator what to do, and folded behind it the figures.
 * @param {Pick<Demonstration, "advice" | "reasons">} demonstration
 * @param {...string} words what else is to be said of it
 */
export function verdictExplanation({ advice, reasons }, ...words) {
  const said = [...words, advice].filter(Boolean).join("; ");
  const figures = capitalize(reasons.join("; "));
  if (!said) return figures && element("span", { class: "why" }, figures);
  if (!figures) return element("span", { class: "why" }, capitalize(said));
  return element("details", { class: "why" }, element("summary", {}, capitalize(said)), figures);
}

/** @param {Demonstration} demonstration */
export function demonstrationRow({ number, verdict, discarded_ns, duration, statistics, reasons, advice }) {
  const { received, lost } = statistics;
  const word = discarded_ns ? "discarded" : verdict;
  const figure = `${formatNumber(duration, 1, "s")}, ${lost} of ${formatNumber(received + lost, 0)} lost`;
  return element(
    "li",
    { class: word, value: String(number) },
    element("span", { class: "number" }, String(number)),
    element("span", { class: "verdict" }, word),
    element("span", { class: "figure" }, figure),
    verdictExplanation({ advice, reasons }),
  );
}
