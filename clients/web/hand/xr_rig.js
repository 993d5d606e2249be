// Places the operator of a headset at the free side of the table, facing the arm, and draws the view's scene with a renderer
// and a camera of its own, so that the view on the page stays as it is.
import { FrameSkipper } from "./frame_skipping.js";

const OPERATOR_POSITION = [1.25, 0, 0]; // [m] robot coordinates, on the floor

export class XrRig {
  #placed = false;

  /** @param {MeshCatViewer} viewer */
  constructor(viewer) {
    const { THREE } = globalThis.MeshCat;
    this.viewer = viewer;
    this.frameSkipper = new FrameSkipper();
    this.framesDrawn = 0;
    this.busy = false; // a demonstration is under way, or may begin at any moment
    this.renderer = new THREE.WebGLRenderer({ antialias: true }); // without it three of this age fails on some headsets
    this.renderer.xr.enabled = true;
    this.camera = new THREE.PerspectiveCamera(70, 1, 0.02, 30);
    // The room of the headset: x right, y up, -z ahead; turned so that ahead is against the robot's x.
    this.room = new THREE.Group();
    const [x, y, z] = OPERATOR_POSITION;
    this.room.position.set(x, z, -y);
    this.room.rotation.y = Math.PI / 2;
    this.room.add(this.camera);
    this.room.updateMatrixWorld(true);
    this.marker = new THREE.Mesh(
      new THREE.SphereGeometry(0.012, 20, 14),
      new THREE.MeshLambertMaterial({ color: 0x3f7fbf }),
    );
    viewer.scene.add(this.marker);
    this.textPanel = new TextPanel();
    viewer.scene.add(this.textPanel.sprite);
  }

  /** @param {string} text */
  setText(text) {
    this.textPanel.setText(text);
  }

  /**
   * @param {XRSession} session
   * @param {(time: number, frame: XRFrame, space: XRReferenceSpace) => void} onFrame called before each frame is drawn
   */
  async present(session, onFrame) {
    const { xr } = this.renderer;
    this.renderer.setAnimationLoop((time, drawn) => {
      const frame = /** @type {any} */ (drawn); // three declares WebXR's types anew
      const space = /** @type {any} */ (xr.getReferenceSpace());
      if (!frame || !space) return;
      if (!this.#placed) this.#placeOperator(frame, space);
      onFrame(time, frame, space);
      if (!this.frameSkipper.shouldRender(time, this.busy)) return;
      this.framesDrawn += 1;
      this.renderer.render(this.viewer.scene, this.camera);
    });
    xr.setReferenceSpaceType("local-floor");
    await xr.setSession(/** @type {any} */ (session)); // after the loop was set, else every frame would come twice
  }

  /**
   * The head's first position becomes the place at the table, wherever in the room the operator is.
   * @param {XRFrame} frame
   * @param {XRReferenceSpace} space
   */
  #placeOperator(frame, space) {
    const head = frame.getViewerPose(space);
    if (!head) return;
    const { x, z } = head.transform.position;
    const { x: a, y: b, z: c, w } = head.transform.orientation;
    const yaw = Math.atan2(2 * (w * b + a * c), 1 - 2 * (b * b + a * a)); // about y, to the left
    this.room.rotation.y = Math.PI / 2 - yaw;
    const [cos, sin] = [Math.cos(this.room.rotation.y), Math.sin(this.room.rotation.y)];
    this.room.position.set(
      OPERATOR_POSITION[0] - (x * cos + z * sin),
      OPERATOR_POSITION[2],
      -OPERATOR_POSITION[1] + x * sin - z * cos,
    );
    this.room.updateMatrixWorld(true);
    this.#placed = true;
  }

  /**
   * A pose of the reference space in robot coordinates; orientation w, x, y, z.
   * @param {Point} position
   * @param {DOMPointReadOnly} orientation
   */
  toRobot([x, y, z], orientation) {
    const { THREE } = globalThis.MeshCat;
    const { viewer } = this;
    const place = viewer.scene.worldToLocal(this.room.localToWorld(new THREE.Vector3(x, y, z)));
    this.marker.position.copy(place);
    const turn = viewer.scene
      .getWorldQuaternion(new THREE.Quaternion())
      .invert()
      .multiply(this.room.getWorldQuaternion(new THREE.Quaternion()))
      .multiply(new THREE.Quaternion(orientation.x, orientation.y, orientation.z, orientation.w))
      .normalize();
    return { position: place.toArray(), orientation: [turn.w, turn.x, turn.y, turn.z] };
  }

  dispose() {
    this.renderer.setAnimationLoop(null);
    this.viewer.scene.remove(this.marker, this.textPanel.sprite);
    this.marker.geometry.dispose();
    this.marker.material.dispose();
    this.textPanel.dispose();
    this.renderer.dispose();
    this.viewer.set_dirty();
  }
}

// A sentence behind the table, for an operator who cannot see the page.
class TextPanel {
  #text = "";

  constructor() {
    const { THREE } = globalThis.MeshCat;
    this.canvas = Object.assign(document.createElement("canvas"), { width: 1024, height: 128 });
    this.texture = new THREE.CanvasTexture(this.canvas);
    this.sprite = new THREE.Sprite(new THREE.SpriteMaterial({ map: this.texture }));
    this.sprite.position.set(0.1, 0, 1.25);
    this.sprite.scale.set(1.2, 0.15, 1);
  }

  /** @param {string} text */
  setText(text) {
    if (text === this.#text) return;
    this.#text = text;
    const context = this.canvas.getContext("2d");
    if (!context) return;
    context.fillStyle = "#1d242c";
    context.fillRect(0, 0, 1024, 128);
    context.fillStyle = "#ffffff";
    context.font = "44px system-ui, sans-serif";
    context.textAlign = "center";
    context.textBaseline = "middle";
    context.fillText(text, 512, 64, 990);
    this.texture.needsUpdate = true;
  }

  dispose() {
    this.texture.dispose();
    this.sprite.material.dispose();
  }
}
