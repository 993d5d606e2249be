// Mouse and touch: press on the object to grasp it, drag over a horizontal plane; shift, the wheel or a second finger
// change the height; let go to release.
const GRAB_RADIUS = { mouse: 28, pen: 32, touch: 48 }; // [px] around the object
const METRES_PER_WHEEL_PIXEL = 0.0004; // [m] of height for a pixel of the wheel
const METRES_PER_FINGER_PIXEL = 0.0012; // [m] of height for a pixel of the second finger

// `handModel` as in hand_model.js; `canGrasp()`: whether the object may be grasped now; `grasp()` and `release()` do so.
// Returns what detaches the listeners.
export function attachPointerDrag(overlay, handModel, { canGrasp, grasp, release }) {
  let first = null; // id of the pointer that carries
  let second = null; // {id, y} of the finger for the height
  let plane = null; // {normal, through, offset, vertical} in which the object is dragged

  function hold(event) {
    const vertical = event.shiftKey;
    const normal = vertical ? viewDirection(overlay) : [0, 0, 1];
    const through = [...handModel.target];
    const hit = overlay.unproject(event.clientX, event.clientY, { through, normal });
    plane = hit && { vertical, normal, through, offset: through.map((value, i) => value - hit[i]) };
  }

  function drag(event) {
    if (!plane || plane.vertical !== event.shiftKey) hold(event);
    const hit = plane && overlay.unproject(event.clientX, event.clientY, plane);
    if (hit) handModel.setTarget(hit.map((value, i) => value + plane.offset[i]));
  }

  function lift(metres, event) {
    const [x, y, z] = handModel.target;
    handModel.setTarget([x, y, z + metres]);
    if (event) hold(event);
    else plane = null;
  }

  const drop = overlay.capturePointer({
    down(event) {
      if (first !== null) {
        if (event.pointerType !== "touch" || second) return false;
        second = { id: event.pointerId, y: event.clientY };
        return true;
      }
      if (event.button !== 0 || !canGrasp()) return false;
      const seen = overlay.project(handModel.position);
      if (
        !seen ||
        Math.hypot(event.clientX - seen[0], event.clientY - seen[1]) >
          (GRAB_RADIUS[event.pointerType] ?? GRAB_RADIUS.mouse)
      )
        return false;
      first = event.pointerId;
      hold(event);
      grasp();
      return true;
    },
    move(event) {
      if (second?.id === event.pointerId) {
        lift((second.y - event.clientY) * METRES_PER_FINGER_PIXEL);
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

  // In the capture phase, before the camera's listener: while the object is carried, the wheel changes its height.
  function wheel(event) {
    if (first === null) return;
    event.preventDefault();
    event.stopImmediatePropagation();
    lift(-event.deltaY * METRES_PER_WHEEL_PIXEL, event);
  }
  overlay.element.addEventListener("wheel", wheel, { capture: true, passive: false });
  return () => {
    drop();
    overlay.element.removeEventListener("wheel", wheel, { capture: true });
    if (first !== null) release();
  };
}

// Level direction from the object to the camera: normal of the upright plane that faces it.
export function viewDirection(overlay) {
  const away = overlay.ray(...middle(overlay.element)).direction;
  const length = Math.hypot(away[0], away[1]) || 1;
  return [-away[0] / length, -away[1] / length, 0];
}

function middle(element) {
  const box = element.getBoundingClientRect();
  return [box.left + box.width / 2, box.top + box.height / 2];
}
