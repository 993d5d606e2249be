// The focus: the demonstration or path that is pointed at, in a table or in the view, and marked everywhere.
import { closestData } from "../elements.js";

/**
 * Put the focus on what elements with data-focus stand for while the pointer or the keyboard is on them.
 * @param {HTMLElement} place
 * @param {import("../store.js").Store} store
 */
export function trackFocus(place, store) {
  /** @param {Event} event */
  const focus = (event) => {
    const [kind, id] = (closestData(event, "[data-focus]").focus ?? "").split(" ");
    store.set({ focus: kind ? { kind, id } : null });
  };
  place.addEventListener("pointerover", focus);
  place.addEventListener("focusin", focus);
  place.addEventListener("pointerleave", () => store.set({ focus: null }));
}

/** @param {HTMLElement} place @param {Focus | null} focus */
export function markFocus(place, focus) {
  const key = focus && `${focus.kind} ${focus.id}`;
  for (const marked of place.querySelectorAll("[data-focus]")) {
    marked.classList.toggle("focused", marked.getAttribute("data-focus") === key);
  }
}
