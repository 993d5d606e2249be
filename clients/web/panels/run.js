// Run: a preview by a ghost arm, then the arm itself, by a plan or by a live hand, its joints, and past executions.
import { armControls } from "./arm_controls.js";
import { executionReplay } from "./execution_replay.js";
import { liveJoints } from "./live_joints.js";
import { planPreview } from "./plan_preview.js";
import { sectionedPanel } from "./sectioned_panel.js";
import { teleopPanel } from "./teleop_panel.js";

const run = sectionedPanel("run", "Run", [
  ["preview", "Preview", planPreview],
  ["arm", "Arm", armControls],
  ["teleop", "Live hand", teleopPanel],
  ["joints", "Joints", liveJoints],
  ["replay", "Past executions", executionReplay],
]);
const ghostPose = (name) => run.section(name).player.ghost?.linkMatrices() ?? null;

// previewGhost(), replayGhost(): poses of the links of the two ghost arms as drawn, or null; teleop(): the session with a live
// hand, or null. For tests.
export const panel = {
  ...run,
  previewGhost: () => ghostPose("preview"),
  replayGhost: () => ghostPose("replay"),
  teleop: () => run.section("teleop").session(),
};
