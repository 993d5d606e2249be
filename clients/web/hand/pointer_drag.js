// Mouse and touch: press on the object to grasp it, drag over a horizontal plane; shift, the wheel or a second finger
// change the height; let go to release.
/** @type {Record<string, number>} */
const GRASP_RADIUS = { mouse: 28, pen: 32, touch: 48 }; // [px] around the object
const METRES_PER_WHEEL_PIXEL = 0.0004; // [m] of height for a pixel of the wheel
const METRES_PER_FINGER_PIXEL = 0.0012; // [m] of height for a pixel of the second finger

/**
 * Returns what detaches the listeners.
 * @param {import("../overlay.js").Overlay} overlay
 * @param {import("./hand_model.js").HandModel} handModel
 * @param {HandActions} actions
 */
export function attachPointerDrag(overlay, handModel, { canGrasp, grasp, release }) {
  /** @type {number | null} */
  let first = null; // id of the pointer that carries
  /** @type {{id: number, y: number} | null} */
  let second = null; // of the finger for the height
  /** @type {{normal: Point, through: Point, offset: Point, vertical: boolean} | null} */
  let plane = null; // in which the object is dragged

  /** @param {MouseEvent} event */
  function hold(event) {
    const vertical = event.shiftKey;
    const normal = vertical ? viewDirection(overlay) : [0, 0, 1];
    const through = [...handModel.target];
    const hit = overlay.unproject(event.clientX, event.clientY, { through, normal });
    plane = hit && { vertical, normal, through, offset: through.map((value, i) => value - hit[i]) };
  }

  /** @param {PointerEvent} event */
  function drag(event) {
    if (!plane || plane.vertical !== event.shiftKey) hold(event);
    if (!plane) return;
    const { offset } = plane;
    const hit = overlay.unproject(event.clientX, event.clientY, plane);
    if (hit) handModel.setTarget(hit.map((value, i) => value + offset[i]));
  }

  /** @param {number} metres @param {MouseEvent} [event] */
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
          (GRASP_RADIUS[event.pointerType] ?? GRASP_RADIUS.mouse)
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
  /** @param {WheelEvent} event */
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

/**
 * Level direction from the object to the camera: normal of the upright plane that faces it.
 * @param {import("../overlay.js").Overlay} overlay
 */
export function viewDirection(overlay) {
  const box = overlay.element.getBoundingClientRect();
  const away = overlay.ray(box.left + box.width / 2, box.top + box.height / 2).direction;
  const length = Math.hypot(away[0], away[1]) || 1;
  return [-away[0] / length, -away[1] / length, 0];
}
