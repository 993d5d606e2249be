// The certificate of the chosen way's plan: how near each limit is approached and where, and what it was signed as.
import { definitionList, element, hideSection } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { formatLength, formatNumber, formatPercent } from "../texts.js";

/** @type {[name: string, key: "position_use" | "velocity_use" | "acceleration_use" | "jerk_use" | "torque_use"][]} */
const USES = [
  ["Joint ranges", "position_use"],
  ["Joint speeds", "velocity_use"],
  ["Accelerations", "acceleration_use"],
  ["Jerks", "jerk_use"],
  ["Torques", "torque_use"],
];

/** @param {HTMLElement} place @returns {Section} */
export function certificate(place) {
  return {
    update({ plan }) {
      hideSection(place, !plan);
      if (plan) patchChildren(place, content(plan));
    },
  };
}

/** @param {Plan} plan @returns {Child[]} */
function content({ certificate }) {
  const { clearance, digest, tool_speed } = certificate;
  return [
    definitionList([
      ...USES.map(([name, key]) => {
        const { value, place } = certificate[key];
        return /** @type {Fact} */ ([name, `${formatPercent(value)}, ${place}`]);
      }),
      tool_speed && ["Speed in space", `${formatNumber(tool_speed.value, 3, "m/s")}, ${tool_speed.place}`],
      ["Clearance", `${formatLength(clearance.value)}, ${clearance.place}`],
    ]),
    element("p", { class: "note" }, "Shares of the limits, at most 100\u202f% of each, and where they are reached."),
    element("p", { class: "digest" }, "SHA-256 ", element("code", {}, digest)),
  ];
}
