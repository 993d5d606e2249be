// What the arm itself says: whether its drives are on, what has stopped it, and how far its fingers are apart.
import { definitionList, element } from "../elements.js";
import { patchChildren } from "../patch_children.js";
import { formatNumber } from "../texts.js";

/** @typedef {import("./live_joints.js").JointState} JointState */
/** @typedef {Pick<JointState, "enabled" | "protective_stop" | "fault" | "gripper_closed" | "gripper_opening" | "output">} DriverState */

/** @param {HTMLElement} place */
export function driverState(place) {
  let shown = "";
  return {
    /** @param {DriverState} state */
    update(state) {
      const trouble = driverTrouble(state);
      const gripper = gripperText(state);
      if (shown === trouble + gripper + state.output) return;
      shown = trouble + gripper + state.output;
      patchChildren(place, [
        trouble && element("p", { class: "failed", role: "alert" }, trouble),
        definitionList([
          ["Drives", state.enabled ? "on" : "off"],
          ["Gripper", gripper],
          state.output ? ["Output", `${state.output} is on`] : null,
        ]),
      ]);
    },
  };
}

/**
 * Why the arm follows no setpoint, and what to do; "" when it does.
 * @param {DriverState} state
 */
export function driverTrouble({ enabled, protective_stop, fault }) {
  if (fault) return `The arm reports a fault: ${fault}. Clear it at the arm.`;
  if (protective_stop)
    return "Protective stop: the arm's own controller has stopped it. See why, and release it at the arm.";
  return enabled ? "" : "The arm's drives are off. Switch them on at the arm.";
}

/** @param {DriverState} state */
export function gripperText({ gripper_closed, gripper_opening }) {
  if (gripper_opening === null) return gripper_closed ? "closed, not measured" : "open, not measured";
  return `${gripper_closed ? "closed" : "open"}, ${formatNumber(gripper_opening * 1000, 0, "mm")} measured`;
}
