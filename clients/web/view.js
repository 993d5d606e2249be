// The 3-D view: meshcat's viewer as a library. The service's part of it comes in batches, see view_feed.js.

import { fitCamera, framePoints, moveCamera } from "./camera.js";
import { createCompass } from "./compass.js";
import { createEnvironment } from "./environment.js";
import { Overlay } from "./overlay.js";

const SERVICE_OBJECTS = ["robot", "object", "hand"]; // what the service draws; the rest is the page's own
/** What the page draws, and the layer that it is shown with. @type {Record<string, string>} */
const LAYERS = {
  demonstrations: "demonstrations",
  paths: "paths",
  marks: "paths",
  names: "paths",
  deviations: "deviations",
  spread: "spread",
  hand: "hand",
};
const [PALE, WEAK] = [0.16, 0.4]; // shares of the opacity: beside what is pointed at, beside what is chosen

export class View {
  /**
   * @param {HTMLElement} element
   * @param {() => void} onReady called when the arm or a scene has been drawn
   */
  constructor(element, onReady) {
    this.viewer = new globalThis.MeshCat.Viewer(element);
    this.builtins = new Set(Object.keys(this.viewer.scene_tree.children)); // meshcat's own
    this.onReady = onReady;
    this.hiddenLayers = new Set(["spread"]);
    /** @type {Set<string> | null} */
    this.highlightedNames = null;
    this.draws = 0;
    this.renderTime = 0; // [ms] that handing the newest draw to the graphics card took
    this.chosenPath = ""; // id of the learned path that stands out
    /** @type {Set<string>} */
    this.dimmedKinds = new Set(); // kinds that are drawn pale, so that what is edited stands out
    this.lastDraw = 0; // [ms]
    this.frameInterval = 0; // [ms] between two draws
    this.element = element;
    this.framedFor = ""; // the objects and the size that the camera was last fitted to
    this.cameraMoved = false; // by the operator: it stays where it is
    this.environment = createEnvironment(this.viewer);
    this.showAxes = createCompass(element.parentElement ?? element);
    this.#sizeTo(element);
    this.overlay = new Overlay(this.viewer, element);
  }

  /** @param {string} layer @param {boolean} visible */
  setLayerVisible(layer, visible) {
    if (visible) this.hiddenLayers.delete(layer);
    else this.hiddenLayers.add(layer);
    this.refresh();
  }

  /**
   * Draw no more often than every so many milliseconds, and shadows as they are: where the machine cannot draw and sample a
   * hand at once, the samples come first. 0: as often as wanted.
   * @param {number} milliseconds
   */
  setFrameInterval(milliseconds) {
    this.frameInterval = milliseconds;
    this.viewer.renderer.shadowMap.autoUpdate = milliseconds === 0;
  }

  resetCamera() {
    this.cameraMoved = false;
    fitCamera(this.viewer);
  }

  /** Show everything from a direction. @param {number[]} from see VIEWPOINTS in camera.js */
  lookFrom(from) {
    this.cameraMoved = true;
    fitCamera(this.viewer, from);
  }

  /** Show some points as near as they go, from where the camera is. @param {Point[]} points */
  frame(points) {
    this.cameraMoved = true;
    framePoints(this.viewer, points);
  }

  /** Turn the view about what it shows, or bring it nearer. @param {Parameters<typeof moveCamera>[1]} by */
  move(by) {
    this.cameraMoved = true;
    moveCamera(this.viewer, by);
  }

  /** Whether the camera is fitted to what is there now: else the next draw may move it. */
  get isFramed() {
    return this.framedFor === this.#frame();
  }

  /** @param {string} layer */
  isLayerVisible(layer) {
    return !this.hiddenLayers.has(layer);
  }

  /**
   * Draw the things of these names, like "paths/ID", in full and the others pale; null: all in full.
   * @param {Set<string> | null} names
   */
  highlight(names) {
    this.highlightedNames = names;
    this.refresh();
  }

  /**
   * Draw the learned path that is chosen in full while nothing is highlighted, and the others weaker.
   * @param {string} id "": none is
   */
  standOut(id) {
    if (id === this.chosenPath) return;
    this.chosenPath = id;
    this.refresh();
  }

  /**
   * Draw a whole kind pale, whatever is highlighted, or not any more.
   * @param {string} kind
   * @param {boolean} dimmed
   */
  setDimmed(kind, dimmed) {
    this.dimmedKinds[dimmed ? "add" : "delete"](kind);
    this.refresh();
  }

  /** Apply visibility and dimming to what has just been added, and draw. */
  refresh() {
    for (const [kind, layer] of Object.entries(LAYERS)) {
      const drawn = this.viewer.scene_tree.children[kind];
      if (!drawn) continue;
      drawn.object.visible = !this.hiddenLayers.has(layer);
      if (kind === "hand") continue;
      for (const [id, node] of Object.entries(drawn.children)) dimMaterial(materialOf(node), this.#share(layer, id));
    }
    this.viewer.set_dirty();
  }

  /** The share of its opacity with which something is drawn. @param {string} layer @param {string} id */
  #share(layer, id) {
    const names = this.highlightedNames;
    if (this.dimmedKinds.has(layer) || (names !== null && !names.has(`${layer}/${id}`))) return PALE;
    return layer === "paths" && names === null && this.chosenPath && id !== this.chosenPath ? WEAK : 1;
  }

  /** Paths that hold a drawn object, e.g. "/robot/link2/upper". */
  objectPaths() {
    /** @type {string[]} */
    const found = [];
    /** @param {MeshCatNode} node @param {string} path */
    const walk = (node, path) => {
      if (node.children["<object>"]) found.push(path);
      for (const [name, child] of Object.entries(node.children))
        if (name !== "<object>") walk(child, `${path}/${name}`);
    };
    walk(this.viewer.scene_tree, "");
    return found.filter((path) => !this.builtins.has(path.split("/")[1])).sort();
  }

  /**
   * How much a line or tube covers what is behind it; null when there is none.
   * @param {string} path
   */
  opacity(path) {
    return materialOf(this.#node(path))?.opacity ?? null;
  }

  /**
   * World matrix of a path, column by column, three's y-up frame; null when there is none.
   * @param {string} path
   */
  worldMatrix(path) {
    const node = this.#node(path);
    if (!node) return null;
    node.object.updateWorldMatrix(true, false);
    return node.object.matrixWorld.toArray();
  }

  /** @param {string} path */
  #node(path) {
    /** @type {MeshCatNode | undefined} */
    let node = this.viewer.scene_tree;
    for (const name of path.split("/").filter(Boolean)) node = node?.children[name];
    return node;
  }

  /**
   * Apply a batch of commands, [u32 little-endian length][umsgpack command] one after the other.
   * @param {ArrayBuffer} batch
   */
  draw(batch) {
    const bytes = new DataView(batch);
    for (let at = 0; at + 4 <= bytes.byteLength; ) {
      const length = bytes.getUint32(at, true);
      this.viewer.handle_command_bytearray(new Uint8Array(batch, at + 4, length));
      at += 4 + length;
    }
    this.environment.placeStand();
    this.viewer.set_dirty();
  }

  /** Remove what the service has drawn. Only what exists: meshcat makes an empty group of every path it is asked for. */
  clearServiceObjects() {
    for (const name of SERVICE_OBJECTS) if (this.viewer.scene_tree.children[name]) this.viewer.delete_path([name]);
  }

  /** @param {HTMLElement} element */
  #sizeTo(element) {
    // meshcat sizes itself by the window, and its control panel covers the view: both are ours to decide.
    const viewer = this.viewer;
    viewer.gui.domElement.remove();
    const resize = Object.getPrototypeOf(viewer).set_3d_pane_size.bind(viewer);
    viewer.set_3d_pane_size = () => resize(Math.max(1, element.clientWidth), Math.max(1, element.clientHeight));
    new ResizeObserver(() => {
      viewer.set_3d_pane_size();
      this.framedFor = "";
    }).observe(element);
    viewer.controls.addEventListener("start", () => {
      this.cameraMoved = true;
    });
    const render = Object.getPrototypeOf(viewer).render.bind(viewer);
    viewer.render = () => {
      if (performance.now() - this.lastDraw < this.frameInterval) return; // it stays dirty and is asked again with the next frame
      this.lastDraw = performance.now();
      const frame = this.#frame();
      if (frame !== this.framedFor && !this.cameraMoved) fitCamera(viewer);
      this.framedFor = frame;
      const began = performance.now();
      render();
      this.renderTime = performance.now() - began;
      this.showAxes(viewer.camera);
      this.draws += 1;
      if (this.#framedObjects().length) this.onReady();
    };
  }

  #framedObjects() {
    return Object.keys(this.viewer.scene_tree.children).filter((name) => ["robot", "scene", "paths"].includes(name));
  }

  #frame() {
    return `${this.#framedObjects()} ${this.element.clientWidth} ${this.element.clientHeight}`;
  }
}

/**
 * The material of a line or tube that is drawn at a node.
 * @param {MeshCatNode | undefined} node
 */
function materialOf(node) {
  const drawn = /** @type {THREE.Mesh | undefined} */ (node?.children["<object>"]?.object);
  return /** @type {THREE.Material | undefined} */ (drawn?.material);
}

/** @param {THREE.Material | undefined} material @param {number} share of its opacity */
function dimMaterial(material, share) {
  if (!material) return;
  material.userData.opacity ??= material.opacity;
  material.opacity = material.userData.opacity * share;
  material.transparent = material.opacity < 1 || !material.depthTest;
  material.depthWrite = material.opacity === 1;
}
