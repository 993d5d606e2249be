// Run: preview as a ghost, then the arm itself, by a plan or by a live hand, its joints, and what was executed before.
import { control } from "./arm_controls.js";
import { leading } from "./teleop_panel.js";
import { live } from "./live_joints.js";
import { composed } from "./sectioned_panel.js";
import { preview } from "./plan_preview.js";
import { replay } from "./execution_replay.js";

const run = composed("run", "Run", [
  ["preview", "Preview", preview],
  ["arm", "Arm", control],
  ["leading", "Live hand", leading],
  ["joints", "Joints", live],
  ["replay", "Past executions", replay],
]);
const drawn = (name) => run.part(name).player.ghost?.frames() ?? null;

// ghost(), replayed(): poses of the links of the two ghosts as drawn, or null; leading(): the sitting with a live hand, or
// null. For tests, and the curious.
export const panel = { ...run, ghost: () => drawn("preview"), replayed: () => drawn("replay"), leading: () => run.part("leading").sitting() };
