// Keyboard and gamepad: velocities of the hand, as seen by the camera, and the grasp, or the clutch that is held.
import { viewDirection } from "./pointer_drag.js";

const SPEED = 0.35; // [m/s] at full deflection, or while a key is held
const DEAD_ZONE = 0.15; // share of a stick's deflection that counts as none
/** @type {Record<string, number[]>} */
const KEYS = {
  ArrowLeft: [-1, 0, 0],
  ArrowRight: [1, 0, 0],
  ArrowUp: [0, 1, 0],
  ArrowDown: [0, -1, 0],
  PageUp: [0, 0, 1],
  PageDown: [0, 0, -1],
};

/**
 * Returns {step(seconds), end()}; step is called with every sample.
 * @param {import("../overlay.js").Overlay} overlay
 * @param {import("./hand_model.js").HandModel} handModel
 * @param {HandActions} actions
 * @param {{held?: boolean, places?: HTMLElement[]}} options `held`: Enter must be held, and letting it go releases; else it is
 *   pressed once to grasp and once to release. `places`: elements beside the view whose keys count.
 */
export function attachKeyboardGamepad(
  overlay,
  handModel,
  { canGrasp, grasp, release },
  { held: mustHold = false, places = [] } = {},
) {
  /** @type {Set<string>} */
  const held = new Set();
  let button = false; // of the gamepad
  let entered = false; // Enter is held

  /** @param {boolean} closed */
  function toggle(closed) {
    if (closed && !handModel.grasped && canGrasp()) grasp();
    else if (!closed && handModel.grasped) release();
  }

  /** @param {KeyboardEvent} event */
  function down(event) {
    if (event.key === "Enter") {
      if (!event.repeat) toggle(mustHold || !handModel.grasped);
      entered = true;
    } else if (event.key in KEYS) held.add(event.key);
    else return;
    event.preventDefault();
  }
  // Only what Enter holds: the focus also leaves for where the pointer was pressed.
  function letGo() {
    if (mustHold && entered) toggle(false);
    entered = false;
  }
  /** @param {KeyboardEvent} event */
  const up = (event) => {
    held.delete(event.key);
    if (event.key === "Enter") letGo();
  };
  const leave = () => {
    held.clear();
    letGo();
  };
  const listening = new AbortController();
  const { signal } = listening;
  for (const place of [overlay.element, ...places]) {
    place.addEventListener("keydown", down, { signal });
    place.addEventListener("keyup", up, { signal });
    place.addEventListener("blur", leave, { signal });
  }

  function readVelocity() {
    const sum = [0, 0, 0];
    /** @param {number[]} velocity */
    const add = (velocity) => {
      for (const [i, value] of velocity.entries()) sum[i] += value;
    };
    for (const key of held) add(KEYS[key]);
    const pad = [...(navigator.getGamepads?.() ?? [])].find((one) => one?.connected);
    if (pad) {
      /** @param {number} index */
      const stick = (index) => (Math.abs(pad.axes[index] ?? 0) > DEAD_ZONE ? pad.axes[index] : 0);
      add([stick(0), -stick(1), -stick(3)]);
      const pressed = Boolean(pad.buttons[0]?.pressed || pad.buttons[7]?.pressed);
      if (pressed !== button) toggle(pressed);
      button = pressed;
    }
    return sum.map((value) => Math.max(-1, Math.min(1, value)));
  }

  return {
    /** @param {number} seconds */
    step(seconds) {
      const [right, ahead, above] = readVelocity();
      if (!handModel.grasped || (!right && !ahead && !above)) return;
      const [x, y] = viewDirection(overlay).map((value) => -value); // away from the camera
      const [a, b] = [x * ahead + y * right, y * ahead - x * right];
      handModel.setTarget([
        handModel.target[0] + a * SPEED * seconds,
        handModel.target[1] + b * SPEED * seconds,
        handModel.target[2] + above * SPEED * seconds,
      ]);
    },
    end() {
      listening.abort();
    },
  };
}
