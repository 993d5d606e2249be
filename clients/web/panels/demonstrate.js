// Demonstrate: the page's own hand, what is being recorded, and the demonstrations so far with their verdicts.
import { demonstrationCloseup } from "./demonstration_closeup.js";
import { demonstrationList } from "./demonstration_list.js";
import { demonstrationPanel } from "./demonstration_panel.js";
import { importFiles } from "./import_files.js";
import { recordingList } from "./recordings.js";
import { sectionedPanel } from "./sectioned_panel.js";

/** @type {ReturnType<typeof demonstrationPanel>} */
let session;

const demonstrate = sectionedPanel("demonstrate", "Demonstrate", [
  ["demonstration-session", "Show it here", (place, context) => (session = demonstrationPanel(place, context))],
  ["recordings", "Recording", recordingList],
  ["import-files", "From files", importFiles],
  ["demonstrations", "Demonstrations", demonstrationList],
  ["closeup", "Trim and compare", demonstrationCloseup],
]);

// For tests: the headset that is worn now, or null, and the demonstration session, or null.
export const panel = { ...demonstrate, headset: () => session.headset(), session: () => session.session() };
