// The focus: the demonstration or path that is pointed at, in a table or in the view, and marked everywhere.

// Elements with data-focus put the focus on that way while the pointer or the keyboard is on them.
export function trackFocus(place, store) {
  const focus = (event) => {
    const [kind, id] = event.target.closest("[data-focus]")?.dataset.focus.split(" ") ?? [];
    store.set({ focus: kind ? { kind, id } : null });
  };
  place.addEventListener("pointerover", focus);
  place.addEventListener("focusin", focus);
  place.addEventListener("pointerleave", () => store.set({ focus: null }));
}

export function markFocus(place, focus) {
  for (const marked of place.querySelectorAll("[data-focus]")) {
    marked.classList.toggle("focused", Boolean(focus) && marked.dataset.focus === `${focus.kind} ${focus.id}`);
  }
}
