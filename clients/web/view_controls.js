// The controls below the view: which layers are shown, and the camera's way home.

/** @param {import("./view.js").View} view */
export function connectViewControls(view) {
  for (const box of document.querySelectorAll("input[data-layer]")) {
    const { dataset } = /** @type {HTMLInputElement} */ (box);
    box.addEventListener("change", () => {
      view.setLayerVisible(dataset.layer ?? "", /** @type {HTMLInputElement} */ (box).checked);
    });
  }
  document.getElementById("home")?.addEventListener("click", () => view.resetCamera());
}
