// What panels draw and grab in the 3-D view: all in robot coordinates [m], z up, and never sent to the service.
//
// group            THREE.Group in robot coordinates: add your own objects, call dirty() after every change
// gizmos           THREE.Group without the scene's rotation: where three's TransformControls must be added
// dirty()          ask for one draw; nothing is drawn otherwise
// ghost(name, points, {color, opacity, dashed, width})   draw a line or replace it; points null takes it away
// project(point)   [x, y] in CSS pixels of the window, or null when it is behind the camera
// projector()      the same for many points of one moment
// unproject(x, y, {through, normal})   the point under a pixel on a plane; normal defaults to the view's direction
// ray(x, y)        {origin, direction} under a pixel
// capture(hand)    hand = {down(event), move(event), up(event)}: while down() has returned true the camera stays;
//                  up(null) when the gesture was broken off. Further fingers are asked for in down() too and each
//                  has its up(). Returns what ends it.
// keys(words)      make the view a place whose keys do what the words say; "" takes it back
// hold(value)      keep the camera still (true) while e.g. TransformControls drags, or let it go (false)

export class Easel {
  #ghosts = new Map();
  #hands = [];
  #held = null;

  constructor(viewer, element) {
    const { THREE } = globalThis.MeshCat;
    Object.assign(this, { viewer, element, THREE });
    this.group = new THREE.Group();
    this.gizmos = new THREE.Group();
    viewer.scene.updateMatrixWorld();
    this.gizmos.applyMatrix4(viewer.scene.matrixWorld.clone().invert());
    viewer.scene.add(this.group, this.gizmos);
    this.#listen();
  }

  dirty() {
    this.viewer.set_dirty();
  }

  ghost(name, points, { color = 0x7a8694, opacity = 0.5, dashed = false } = {}) {
    const { THREE } = this;
    const before = this.#ghosts.get(name);
    if (before) {
      this.group.remove(before);
      before.geometry.dispose();
      before.material.dispose();
      this.#ghosts.delete(name);
    }
    if (points?.length > 1) {
      const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
      const look = { color, opacity, transparent: opacity < 1 };
      const material = dashed ? new THREE.LineDashedMaterial({ ...look, dashSize: 0.012, gapSize: 0.008 }) : new THREE.LineBasicMaterial(look);
      const line = new THREE.Line(geometry, material);
      if (dashed) line.computeLineDistances();
      this.group.add(line);
      this.#ghosts.set(name, line);
    }
    this.dirty();
  }

  project(point) {
    return this.projector()(point);
  }

  projector() {
    const box = this.element.getBoundingClientRect();
    const { scene, camera } = this.viewer;
    const place = camera.matrixWorldInverse.clone().premultiply(camera.projectionMatrix).multiply(scene.matrixWorld);
    const at = new this.THREE.Vector3();
    return (point) => {
      at.set(...point).applyMatrix4(place);
      return at.z > 1 ? null : [box.left + ((at.x + 1) / 2) * box.width, box.top + ((1 - at.y) / 2) * box.height];
    };
  }

  ray(x, y) {
    const { origin, direction } = this.#rayInWorld(x, y);
    const start = this.#toRobot(origin.clone());
    const ahead = this.#toRobot(origin.clone().add(direction));
    return { origin: start, direction: ahead.map((value, i) => value - start[i]) };
  }

  unproject(x, y, { through, normal } = {}) {
    const { THREE } = this;
    const at = this.#toWorld(through ?? [0, 0, 0]);
    const facing = normal ? this.#toWorld(normal).sub(this.#toWorld([0, 0, 0])).normalize() : this.viewer.camera.getWorldDirection(new THREE.Vector3());
    const plane = new THREE.Plane().setFromNormalAndCoplanarPoint(facing, at);
    const hit = this.#rayInWorld(x, y).intersectPlane(plane, new THREE.Vector3());
    return hit && this.#toRobot(hit);
  }

  capture(hand) {
    this.#hands.unshift(hand);
    return () => {
      this.#hands = this.#hands.filter((other) => other !== hand);
    };
  }

  keys(words) {
    const said = { tabindex: "0", role: "application", "aria-label": words };
    for (const [name, value] of Object.entries(said)) {
      if (words) this.element.setAttribute(name, value);
      else this.element.removeAttribute(name);
    }
  }

  hold(value) {
    this.viewer.controls.enabled = !value; // read late: meshcat may replace its controls
  }

  // The viewer's own controls listen to mousedown and touchstart on the element; pointerdown comes before both.
  #listen() {
    const pressed = new Set(); // pointers of the gesture: fingers may come and go while it lasts
    const lift = (id, event) => {
      if (!pressed.delete(id)) return;
      const hand = this.#held;
      if (!pressed.size) {
        this.#held = null;
        this.hold(false);
      }
      hand?.up(event);
    };
    const breakOff = (event) => lift(event.pointerId, null);
    this.element.addEventListener("pointerdown", (event) => {
      const hand = this.#held ? this.#held.down(event) && this.#held : this.#hands.find((other) => other.down(event));
      if (!hand) return;
      this.#held = hand;
      pressed.add(event.pointerId);
      this.hold(true);
      this.element.setPointerCapture(event.pointerId);
    });
    this.element.addEventListener("pointermove", (event) => this.#held?.move(event));
    this.element.addEventListener("pointerup", (event) => lift(event.pointerId, event));
    for (const name of ["pointercancel", "lostpointercapture"]) this.element.addEventListener(name, breakOff);
    addEventListener("blur", () => [...pressed].forEach((id) => lift(id, null)));
  }

  #rayInWorld(x, y) {
    const { THREE, viewer } = this;
    const box = this.element.getBoundingClientRect();
    const caster = new THREE.Raycaster();
    caster.setFromCamera({ x: (2 * (x - box.left)) / box.width - 1, y: 1 - (2 * (y - box.top)) / box.height }, viewer.camera);
    return caster.ray;
  }

  #toWorld(point) {
    return this.viewer.scene.localToWorld(new this.THREE.Vector3(...point));
  }

  #toRobot(vector) {
    return this.viewer.scene.worldToLocal(vector).toArray();
  }
}
