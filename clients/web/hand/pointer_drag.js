// Mouse and touch: press on the object to grasp it, drag over a horizontal plane; shift, the wheel or a second finger
// change the height; let go to release.
const REACH = { mouse: 28, pen: 32, touch: 48 }; // [px] around the object
const WHEEL = 0.0004; // [m] of height for a pixel of the wheel
const FINGER = 0.0012; // [m] of height for a pixel of the second finger

// `carry` as in hand_model.js; `may()` tells whether the object may be grasped now; `grasp()` and `release()` are called.
export function pointer(easel, carry, { may, grasp, release }) {
  let first = null; // id of the pointer that carries
  let second = null; // {id, y} of the finger for the height
  let plane = null; // {normal, through, offset, vertical} in which the object is dragged

  function hold(event) {
    const vertical = event.shiftKey;
    const normal = vertical ? facing(easel) : [0, 0, 1];
    const through = [...carry.target];
    const hit = easel.unproject(event.clientX, event.clientY, { through, normal });
    plane = hit && { vertical, normal, through, offset: through.map((value, i) => value - hit[i]) };
  }

  function drag(event) {
    if (!plane || plane.vertical !== event.shiftKey) hold(event);
    const hit = plane && easel.unproject(event.clientX, event.clientY, plane);
    if (hit) carry.aim(hit.map((value, i) => value + plane.offset[i]));
  }

  function lift(metres, event) {
    const [x, y, z] = carry.target;
    carry.aim([x, y, z + metres]);
    if (event) hold(event);
    else plane = null;
  }

  const drop = easel.capture({
    down(event) {
      if (first !== null) {
        if (event.pointerType !== "touch" || second) return false;
        second = { id: event.pointerId, y: event.clientY };
        return true;
      }
      if (event.button !== 0 || !may()) return false;
      const seen = easel.project(carry.position);
      if (!seen || Math.hypot(event.clientX - seen[0], event.clientY - seen[1]) > (REACH[event.pointerType] ?? REACH.mouse)) return false;
      first = event.pointerId;
      hold(event);
      grasp();
      return true;
    },
    move(event) {
      if (second?.id === event.pointerId) {
        lift((second.y - event.clientY) * FINGER);
        second.y = event.clientY;
      } else if (event.pointerId === first) drag(event);
    },
    up(event) {
      if (first === null) return;
      if (event && second?.id === event.pointerId) {
        second = plane = null; // the other finger still carries
        return;
      }
      first = second = plane = null;
      release();
    },
  });

  // Before the camera sees it: while the object is carried, the wheel is its height.
  function wheel(event) {
    if (first === null) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    lift(-event.deltaY * WHEEL, event);
  }
  easel.element.addEventListener("wheel", wheel, { capture: true, passive: false });
  return () => {
    drop();
    easel.element.removeEventListener("wheel", wheel, { capture: true });
    if (first !== null) release();
  };
}

// Level direction from the object to the camera: normal of the upright plane that faces it.
function facing(easel) {
  const away = easel.ray(...middle(easel.element)).direction;
  const length = Math.hypot(away[0], away[1]) || 1;
  return [-away[0] / length, -away[1] / length, 0];
}

function middle(element) {
  const box = element.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
}

export { facing };
