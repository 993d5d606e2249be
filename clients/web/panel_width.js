// The width of the panel beside the view: dragged at its edge, or changed by arrow keys, and kept in this browser.
import { element } from "./elements.js";

const KEY = "panel-width";
const [LEAST, VIEW_LEAST] = [320, 360]; // [px] of the panel, of the view beside it
const STEP = 24; // [px] of an arrow key

/** @param {HTMLElement} panel at the right of the view */
export function panelWidth(panel) {
  const handle = element("div", {
    class: "panel-edge",
    role: "separator",
    tabindex: "0",
    "aria-orientation": "vertical",
    "aria-label": "Width of the panel",
    "aria-valuemin": LEAST,
    title: "Drag, or use the arrow keys, for a wider or narrower panel; twice pressed: as it was",
  });
  panel.prepend(handle);
  /** @param {number | null} wanted [px]; null: what the page makes it by itself */
  const set = (wanted) => {
    panel.style.width = wanted === null ? "" : `${allowedWidth(wanted, innerWidth)}px`;
    if (wanted === null) localStorage.removeItem(KEY);
    else localStorage.setItem(KEY, String(Math.round(wanted)));
    tell();
  };
  const tell = () => {
    handle.setAttribute("aria-valuemax", String(mostWidth(innerWidth)));
    handle.setAttribute("aria-valuenow", String(Math.round(panel.offsetWidth)));
  };
  const kept = Number(localStorage.getItem(KEY)); // 0: none is
  if (kept) set(kept);
  else tell();
  addEventListener("resize", () => {
    const wanted = Number(localStorage.getItem(KEY));
    if (wanted) panel.style.width = `${allowedWidth(wanted, innerWidth)}px`;
    tell();
  });
  handle.addEventListener("focus", tell);
  handle.addEventListener("pointerdown", (event) => {
    handle.setPointerCapture(event.pointerId);
    event.preventDefault(); // no text is selected
    handle.focus();
  });
  handle.addEventListener("pointermove", (event) => {
    if (handle.hasPointerCapture(event.pointerId)) set(panel.getBoundingClientRect().right - event.clientX);
  });
  handle.addEventListener("dblclick", () => set(null));
  handle.addEventListener("keydown", (event) => {
    const now = panel.offsetWidth;
    const targets = new Map([
      ["ArrowLeft", now + STEP],
      ["ArrowRight", now - STEP],
      ["Home", LEAST],
      ["End", mostWidth(innerWidth)],
    ]);
    const wanted = targets.get(event.key);
    if (wanted === undefined) return;
    event.preventDefault();
    set(wanted);
  });
}

/** The widest that a panel may be in a window [px]: the view keeps its part. @param {number} window */
const mostWidth = (window) => Math.max(LEAST, window - VIEW_LEAST);

/** The width that a panel gets of the one that is wanted, both in pixels. @param {number} wanted @param {number} window */
export const allowedWidth = (wanted, window) => Math.round(Math.min(Math.max(wanted, LEAST), mostWidth(window)));
