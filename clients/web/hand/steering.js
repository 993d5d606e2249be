// Keyboard and gamepad: velocities of the hand, as seen by the camera, and the grasp.
import { facing } from "./pointer.js";

const SPEED = 0.35; // [m/s] at full deflection, or while a key is held
const DEAD = 0.15; // share of a stick's way that counts as none
const KEYS = { ArrowLeft: [-1, 0, 0], ArrowRight: [1, 0, 0], ArrowUp: [0, 1, 0], ArrowDown: [0, -1, 0], PageUp: [0, 0, 1], PageDown: [0, 0, -1] };

// `may`, `grasp` and `release` as in pointer.js. Returns {step(seconds), end()}; step is called with every sample.
export function steering(easel, carry, { may, grasp, release }) {
  const held = new Set();
  let button = false; // of the gamepad

  function toggle(closed) {
    if (closed && !carry.grasped && may()) grasp();
    else if (!closed && carry.grasped) release();
  }

  function down(event) {
    if (event.key === "Enter") {
      if (!event.repeat) toggle(!carry.grasped);
    } else if (event.key in KEYS) held.add(event.key);
    else return;
    event.preventDefault();
  }
  const up = (event) => held.delete(event.key);
  const leave = () => held.clear();
  easel.element.addEventListener("keydown", down);
  easel.element.addEventListener("keyup", up);
  easel.element.addEventListener("blur", leave);

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
      for (const [name, hear] of [["keydown", down], ["keyup", up], ["blur", leave]]) easel.element.removeEventListener(name, hear);
    },
  };
}
