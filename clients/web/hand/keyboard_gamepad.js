// Keyboard and gamepad: velocities of the hand, as seen by the camera, and the grasp, or the clutch that is held.
import { facing } from "./pointer_drag.js";

const SPEED = 0.35; // [m/s] at full deflection, or while a key is held
const DEAD = 0.15; // share of a stick's way that counts as none
const KEYS = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1] };

// `may`, `grasp` and `release` as in pointer_drag.js. `held`: Enter must be held, and letting it go releases; else it is pressed
// once to grasp and once to release. `places`: elements beside the view whose keys count.
// Returns {step(seconds), end()}; step is called with every sample.
export function steering(easel, carry, { may, grasp, release }, { held: mustHold = false, places = [] } = {}) {
  const held = new Set();
  let button = false; // of the gamepad
  let entered = false; // Enter is held

  function toggle(closed) {
    if (closed && !carry.grasped && may()) grasp();
    else if (!closed && carry.grasped) release();
  }

  function down(event) {
    if (event.key === "Enter") {
      if (!event.repeat) toggle(mustHold || !carry.grasped);
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
  const up = (event) => {
    held.delete(event.key);
    if (event.key === "Enter") letGo();
  };
  const leave = () => {
    held.clear();
    letGo();
  };
  const heard = [["keydown", down], ["keyup", up], ["blur", leave]];
  const all = [easel.element, ...places];
  for (const place of all) for (const [name, hear] of heard) place.addEventListener(name, hear);

  function wish() {
    const sum = [0, 0, 0];
    for (const key of held) KEYS[key].forEach((value, i) => (sum[i] += value));
    const pad = [...(navigator.getGamepads?.() ?? [])].find((one) => one?.connected);
    if (pad) {
      const stick = (index) => (Math.abs(pad.axes[index] ?? 0) > DEAD ? pad.axes[index] : 0);
      [stick(0), -stick(1), -stick(3)].forEach((value, i) => (sum[i] += value));
      const pressed = Boolean(pad.buttons[0]?.pressed || pad.buttons[7]?.pressed);
      if (pressed !== button) toggle(pressed);
      button = pressed;
    }
    return sum.map((value) => Math.max(-1, Math.min(1, value)));
  }

  return {
    step(seconds) {
      const [right, ahead, above] = wish();
      if (!carry.grasped || (!right && !ahead && !above)) return;
      const [x, y] = facing(easel).map((value) => -value); // away from the camera
      const [a, b] = [x * ahead + y * right, y * ahead - x * right];
      carry.aim([carry.target[0] + a * SPEED * seconds, carry.target[1] + b * SPEED * seconds, carry.target[2] + above * SPEED * seconds]);
    },
    end() {
      for (const place of all) for (const [name, hear] of heard) place.removeEventListener(name, hear);
    },
  };
}
