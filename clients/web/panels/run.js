// Run: the console of the arm, the motion that it would start as a ghost arm shows it, a live hand, joints, past executions.
import { armControls } from "./arm_controls.js";
import { driverState } from "./driver_state.js";
import { executionReplay } from "./execution_replay.js";
import { liveJoints } from "./live_joints.js";
import { planPreview } from "./plan_preview.js";
import { sectionedPanel } from "./sectioned_panel.js";
import { teleopPanel } from "./teleop_panel.js";

/** @type {ReturnType<typeof planPreview>} */
let preview;
/** @type {ReturnType<typeof executionReplay>} */
let replay;
/** @type {ReturnType<typeof teleopPanel>} */
let teleop;
/** @type {ReturnType<typeof driverState>} */
let driver;

/** @param {HTMLElement} place @param {Context} context */
function armWithDriver(place, context) {
  const controls = armControls(place, context);
  driver = driverState(controls.driver);
  return controls;
}

const run = sectionedPanel("run", "Run", [
  ["arm", "Arm", armWithDriver],
  ["preview", "Motion", (place, context) => (preview = planPreview(place, context))],
  ["teleop", "Live hand", (place, context) => (teleop = teleopPanel(place, context))],
  ["joints", "Joints", (place, context) => liveJoints(place, context, (state) => driver.update(state))],
  ["replay", "Past executions", (place, context) => (replay = executionReplay(place, context))],
]);

// For tests: poses of the links of the two ghost arms as drawn, or null; the session with a live hand and the
// headset that leads, or null.
export const panel = {
  ...run,
  previewGhost: () => preview.player.ghost?.linkMatrices() ?? null,
  replayGhost: () => replay.player.ghost?.linkMatrices() ?? null,
  teleop: () => teleop.session(),
  headset: () => teleop.headset(),
};
