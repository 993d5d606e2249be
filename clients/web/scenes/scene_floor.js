// The height of a scene's floor, in millimetres.
import { block, element } from "../elements.js";
import { numberInput, readNumber } from "../number_input.js";
import { MAX_LENGTH, watchTyping, writeInput } from "./shape_fields.js";

export class SceneFloor {
  /**
   * @param {HTMLElement} place
   * @param {{scene: () => Scene | null, change: (scene: Scene, what: string) => void, refuse: (sentence: string) => void}} editor
   */
  constructor(place, editor) {
    this.input = numberInput({ id: "scene-floor", min: -MAX_LENGTH, max: MAX_LENGTH, unit: "mm" });
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
    const { value, fault } = readNumber(this.input);
    if (!scene) return;
    if (value === undefined) return refuse(`Height of the floor ${this.input.value || "is empty; it"} ${fault}.`);
    change({ ...scene, floor: value / 1000 }, "height of the floor");
  }
}
