// The overlay of the 3-D view: what panels draw and drag there, in robot coordinates [m], z up, and never sent to the service.
//
// group             THREE.Group in robot coordinates: add your own objects, call requestDraw() after every change
// worldGroup        THREE.Group without the scene's rotation: where three's TransformControls must be added
// requestDraw()     ask for one draw; nothing is drawn otherwise
// setLine(name, points, {color, opacity, dashed})   draw a line or replace it; points null removes it
// project(point)    [x, y] in CSS pixels of the window, or null when it is behind the camera
// createProjector() the same function for many points of one moment
// unproject(x, y, {through, normal})   the point under a pixel on a plane; normal defaults to the view's direction
// ray(x, y)         {origin, direction} under a pixel
// capturePointer(handler)   handler = {down(event), move(event), up(event)}: after down() has returned true the camera stays
//                   still until up(event), or up(null) when the gesture was cancelled. Further fingers call down() too, and
//                   each has its up(). Returns what removes the handler.
// setKeyboardLabel(label)   say what the view's keys do, and that they are taken; "": they turn the view again
// lockCamera(locked)        keep the camera still while e.g. TransformControls drags

/**
 * @typedef {object} PointerHandler
 * @property {(event: PointerEvent) => boolean} down whether it takes the gesture
 * @property {(event: PointerEvent) => void} move
 * @property {(event: PointerEvent | null) => void} up null when the gesture was cancelled
 *
 * @typedef {{through?: Point, normal?: Point}} PlaneOptions
 */

const VIEW_KEYS =
  "Arrow keys turn it, plus and minus zoom, 1, 2 and 3 look from the front, the side and above, F shows the chosen way, 0 all.";

export class Overlay {
  /** @type {Map<string, THREE.Line>} */
  #lines = new Map();
  /** @type {PointerHandler[]} */
  #handlers = [];
  /** @type {PointerHandler | null} */
  #activeHandler = null;

  /** @param {MeshCatViewer} viewer @param {HTMLElement} element */
  constructor(viewer, element) {
    const { THREE } = globalThis.MeshCat;
    this.THREE = THREE;
    this.viewer = viewer;
    this.element = element;
    this.group = new THREE.Group();
    this.worldGroup = new THREE.Group();
    viewer.scene.updateMatrixWorld();
    this.worldGroup.applyMatrix4(viewer.scene.matrixWorld.clone().invert());
    viewer.scene.add(this.group, this.worldGroup);
    this.areKeysTaken = false; // by what is carried or edited: else they move the camera
    this.setKeyboardLabel("");
    this.#listen();
  }

  requestDraw() {
    this.viewer.set_dirty();
  }

  /**
   * @param {string} name
   * @param {Point[] | null} points
   * @param {{color?: THREE.ColorRepresentation, opacity?: number, dashed?: boolean}} style
   */
  setLine(name, points, { color = 0x7a8694, opacity = 0.5, dashed = false } = {}) {
    const { THREE } = this;
    const before = this.#lines.get(name);
    if (before) {
      this.group.remove(before);
      before.geometry.dispose();
      /** @type {THREE.Material} */ (before.material).dispose();
      this.#lines.delete(name);
    }
    if (points && points.length > 1) {
      const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3().fromArray(p)));
      const style = { color, opacity, transparent: opacity < 1 };
      const material = dashed
        ? new THREE.LineDashedMaterial({ ...style, dashSize: 0.012, gapSize: 0.008 })
        : new THREE.LineBasicMaterial(style);
      const line = new THREE.Line(geometry, material);
      if (dashed) line.computeLineDistances();
      this.group.add(line);
      this.#lines.set(name, line);
    }
    this.requestDraw();
  }

  /** @param {Point} point */
  project(point) {
    return this.createProjector()(point);
  }

  createProjector() {
    const box = this.element.getBoundingClientRect();
    const { scene, camera } = this.viewer;
    const place = camera.matrixWorldInverse.clone().premultiply(camera.projectionMatrix).multiply(scene.matrixWorld);
    const at = new this.THREE.Vector3();
    /** @param {Point} point */
    return (point) => {
      at.fromArray(point).applyMatrix4(place);
      return at.z > 1 ? null : [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
    };
  }

  /** @param {number} x @param {number} y */
  ray(x, y) {
    const { origin, direction } = this.#rayInWorld(x, y);
    const start = this.#toRobot(origin.clone());
    const ahead = this.#toRobot(origin.clone().add(direction));
    return { origin: start, direction: ahead.map((value, i) => value - start[i]) };
  }

  /** @param {number} x @param {number} y @param {PlaneOptions} plane @returns {Point | null} */
  unproject(x, y, { through, normal } = {}) {
    const { THREE } = this;
    const at = this.#toWorld(through ?? [0, 0, 0]);
    const facing = normal
      ? this.#toWorld(normal)
          .sub(this.#toWorld([0, 0, 0]))
          .normalize()
      : this.viewer.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, at);
    const hit = this.#rayInWorld(x, y).intersectPlane(plane, new THREE.Vector3());
    return hit && this.#toRobot(hit);
  }

  /** @param {PointerHandler} handler */
  capturePointer(handler) {
    this.#handlers.unshift(handler);
    return () => {
      this.#handlers = this.#handlers.filter((other) => other !== handler);
    };
  }

  /** @param {string} label */
  setKeyboardLabel(label) {
    this.areKeysTaken = label !== "";
    const attributes = { tabindex: "0", role: "application", "aria-label": label || `3-D view. ${VIEW_KEYS}` };
    for (const [name, value] of Object.entries(attributes)) this.element.setAttribute(name, value);
  }

  /** @param {boolean} locked */
  lockCamera(locked) {
    this.viewer.controls.enabled = !locked; // read late: meshcat may replace its controls
  }

  // The viewer's own controls listen to mousedown and touchstart on the element; pointerdown comes before both.
  #listen() {
    /** @type {Set<number>} */
    const pressed = new Set(); // pointers of the gesture: fingers may come and go while it lasts
    /** @param {number} id @param {PointerEvent | null} event */
    const lift = (id, event) => {
      if (!pressed.delete(id)) return;
      const handler = this.#activeHandler;
      if (!pressed.size) {
        this.#activeHandler = null;
        this.lockCamera(false);
      }
      handler?.up(event);
    };
    /** @param {PointerEvent} event */
    const cancel = (event) => lift(event.pointerId, null);
    this.element.addEventListener("pointerdown", (event) => {
      const handler = this.#activeHandler
        ? this.#activeHandler.down(event) && this.#activeHandler
        : this.#handlers.find((other) => other.down(event));
      if (!handler) return;
      this.#activeHandler = handler;
      pressed.add(event.pointerId);
      this.lockCamera(true);
      this.element.setPointerCapture(event.pointerId);
    });
    this.element.addEventListener("pointermove", (event) => this.#activeHandler?.move(event));
    this.element.addEventListener("pointerup", (event) => lift(event.pointerId, event));
    for (const name of /** @type {const} */ (["pointercancel", "lostpointercapture"]))
      this.element.addEventListener(name, cancel);
    addEventListener("blur", () => {
      for (const id of [...pressed]) lift(id, null);
    });
  }

  /** @param {number} x @param {number} y */
  #rayInWorld(x, y) {
    const { THREE, viewer } = this;
    const box = this.element.getBoundingClientRect();
    const caster = new THREE.Raycaster();
    caster.setFromCamera(
      { x: (2 * (x - box.left)) / box.width - 1, y: 1 - (2 * (y - box.top)) / box.height },
      viewer.camera,
    );
    return caster.ray;
  }

  /** @param {Point} point */
  #toWorld(point) {
    return this.viewer.scene.localToWorld(new this.THREE.Vector3().fromArray(point));
  }

  /** @param {THREE.Vector3} vector @returns {Point} */
  #toRobot(vector) {
    return this.viewer.scene.worldToLocal(vector).toArray();
  }
}
