// The height of a scene's floor, in millimetres.
import { block, element } from "../elements.js";
import { MAX_LENGTH, watchTyping, writeInput } from "./shape_fields.js";

export class SceneFloor {
  /**
   * @param {HTMLElement} place
   * @param {{scene: () => Scene | null, change: (scene: Scene, what: string) => void, refuse: (sentence: string) => void}} editor
   */
  constructor(place, editor) {
    const limits = { min: -MAX_LENGTH, max: MAX_LENGTH };
    this.input = element("input", { type: "number", id: "scene-floor", step: "any", ...limits });
    const label = element("label", { for: "scene-floor" }, "Height of the floor (mm)");
    place.append(element("p", { class: "field" }, label, this.input));
    watchTyping(this.input);
    this.input.addEventListener("change", () => {
      delete this.input.dataset.typed;
      this.#enter(editor);
      this.show(editor.scene()); // what was refused is as it was
    });
  }

  /** @param {Scene | null} scene */
  show(scene) {
    block(this.input, scene ? "" : "The scene is not read yet.");
    if (scene) writeInput(this.input, String(Number((1000 * scene.floor).toFixed(4))));
  }

  /** @param {{scene: () => Scene | null, change: (scene: Scene, what: string) => void, refuse: (sentence: string) => void}} editor */
  #enter({ scene: current, change, refuse }) {
    const scene = current();
    const { value, min, max } = this.input;
    if (!scene) return;
    if (value === "" || !this.input.checkValidity())
      return refuse(`Height of the floor ${value || "is empty; it"} must be a number from ${min} to ${max}.`);
    change({ ...scene, floor: Number(value) / 1000 }, "height of the floor");
  }
}
