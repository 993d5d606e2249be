// Run: preview as a ghost, then the arm itself, by a plan or by a live hand, its joints, and what was executed before.
import { control } from "./control.js";
import { leading } from "./leading.js";
import { live } from "./live.js";
import { composed } from "./parts.js";
import { preview } from "./preview.js";
import { replay } from "./replay.js";

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
