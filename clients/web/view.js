// The 3-D view: meshcat's viewer as a library, fed by our own WebSocket.
// Server to page: batches of [u32 little-endian length][umsgpack command]; the first batch of a connection is the
// whole scene. Page to server: the number of batches drawn, as text, from the next animation frame.
import { socketAddress } from "./api.js";
import { Easel } from "./overlay.js";
import { dress } from "./environment.js";

const SHORTEST = 250; // [ms] first pause before connecting again
const LONGEST = 5000;
const SERVED = ["robot", "object", "hand"]; // what the service draws; the rest is the page's own
const LAYERS = ["demonstrations", "paths", "departures", "spread", "hand"];

export class View {
  constructor(element, { connected, ready }) {
    this.viewer = new MeshCat.Viewer(element);
    this.own = new Set(Object.keys(this.viewer.scene_tree.children)); // meshcat's own
    this.connected = connected;
    this.ready = ready;
    this.hidden = new Set(["spread"]);
    this.picked = null;
    this.pause = SHORTEST;
    this.draws = 0;
    this.rendering = 0; // [ms] that handing the newest draw to the graphics card took
    this.faded = new Set(); // kinds that are drawn pale, so that what is edited stands out
    this.drawnAt = 0; // [ms]
    this.least = 0; // [ms] between two draws
    this.framed = ""; // what the camera was last set up for
    this.touched = false; // the operator has turned the view: it stays as it is
    this.stage = dress(this.viewer);
    this.#fitTo(element);
    this.easel = new Easel(this.viewer, element);
  }

  connect() {
    this.connected("connecting");
    const socket = new WebSocket(socketAddress("view"));
    socket.binaryType = "arraybuffer";
    let owed = 0;
    let replayed = false;
    socket.onmessage = ({ data }) => {
      if (!replayed) {
        replayed = true;
        this.pause = SHORTEST;
        this.#clear();
        this.connected("live");
      }
      if (owed++ === 0) {
        requestAnimationFrame(() => {
          if (socket.readyState === WebSocket.OPEN) socket.send(String(owed));
          owed = 0;
        });
      }
      this.#apply(data);
    };
    socket.onclose = () => {
      const wait = this.pause * (0.75 + Math.random() / 2);
      this.pause = Math.min(LONGEST, this.pause * 2);
      this.connected("lost", wait / 1000);
      setTimeout(() => this.connect(), wait);
    };
  }

  show(layer, visible) {
    if (visible) this.hidden.delete(layer);
    else this.hidden.add(layer);
    this.refresh();
  }

  // Draw no more often than every so many milliseconds, and shadows as they are: where the machine cannot draw and sample
  // a hand at once, the samples come first. 0: as often as wanted.
  spare(milliseconds) {
    this.least = milliseconds;
    this.viewer.renderer.shadowMap.autoUpdate = milliseconds === 0;
  }

  home() {
    this.touched = false;
    this.stage.look();
  }

  isShown(layer) {
    return !this.hidden.has(layer);
  }

  // Names like "paths/ID" that are drawn in full while the others are pale; null: all are.
  set vivid(names) {
    this.picked = names;
    this.refresh();
  }

  // Draw a whole kind pale, whatever is picked, or not any more.
  fade(kind, faded) {
    this.faded[faded ? "add" : "delete"](kind);
    this.refresh();
  }

  // Let layers and paleness hold for what has just been drawn, and draw.
  refresh() {
    for (const layer of LAYERS) {
      const node = this.viewer.scene_tree.children[layer];
      if (node) node.object.visible = !this.hidden.has(layer);
    }
    for (const kind of ["demonstrations", "paths", "departures", "spread"]) {
      for (const [id, node] of Object.entries(this.viewer.scene_tree.children[kind]?.children ?? {})) {
        this.#fade(node.children["<object>"]?.object.material, this.faded.has(kind) || (this.picked && !this.picked.has(`${kind}/${id}`)));
      }
    }
    this.viewer.set_dirty();
  }

  #fade(material, pale) {
    if (!material) return;
    material.userData.opacity ??= material.opacity;
    material.opacity = material.userData.opacity * (pale ? 0.16 : 1);
    material.transparent = material.opacity < 1 || !material.depthTest;
    material.depthWrite = material.opacity === 1;
  }

  // Paths that hold a drawn object, e.g. "/robot/link2/upper".
  paths() {
    const found = [];
    const walk = (node, path) => {
      if (node.children["<object>"]) found.push(path);
      for (const [name, child] of Object.entries(node.children)) if (name !== "<object>") walk(child, `${path}/${name}`);
    };
    walk(this.viewer.scene_tree, "");
    return found.filter((path) => !this.own.has(path.split("/")[1])).sort();
  }

  // How much a line or tube covers what is behind it; null when there is none.
  opacity(path) {
    return this.#node(path)?.children["<object>"]?.object.material.opacity ?? null;
  }

  // World matrix of a path, column by column, three's y-up frame; null when there is none.
  place(path) {
    const node = this.#node(path);
    if (!node) return null;
    node.object.updateWorldMatrix(true, false);
    return node.object.matrixWorld.toArray();
  }

  #node(path) {
    let node = this.viewer.scene_tree;
    for (const name of path.split("/").filter(Boolean)) node = node?.children[name];
    return node;
  }

  #apply(data) {
    const bytes = new DataView(data);
    for (let at = 0; at + 4 <= bytes.byteLength; ) {
      const length = bytes.getUint32(at, true);
      this.viewer.handle_command_bytearray(new Uint8Array(data, at + 4, length));
      at += 4 + length;
    }
    this.viewer.set_dirty();
  }

  // Only what exists: meshcat makes an empty group of every path it is asked for.
  #clear() {
    for (const name of SERVED) if (this.viewer.scene_tree.children[name]) this.viewer.delete_path([name]);
  }

  #fitTo(element) {
    // meshcat sizes itself by the window, and its control panel covers the view: both are ours to decide.
    const viewer = this.viewer;
    viewer.gui.domElement.remove();
    const resize = Object.getPrototypeOf(viewer).set_3d_pane_size.bind(viewer);
    viewer.set_3d_pane_size = () => resize(Math.max(1, element.clientWidth), Math.max(1, element.clientHeight));
    new ResizeObserver(() => {
      viewer.set_3d_pane_size();
      this.framed = "";
    }).observe(element);
    viewer.controls.addEventListener("start", () => {
      this.touched = true;
    });
    const render = Object.getPrototypeOf(viewer).render.bind(viewer);
    viewer.render = () => {
      if (performance.now() - this.drawnAt < this.least) return; // it stays dirty and is asked again with the next frame
      this.drawnAt = performance.now();
      const here = Object.keys(viewer.scene_tree.children).filter((name) => ["robot", "scene", "paths"].includes(name)).join();
      if (here !== this.framed && !this.touched) {
        this.framed = here;
        this.stage.look();
      }
      const began = performance.now();
      render();
      this.rendering = performance.now() - began;
      this.draws += 1;
      if (here) this.ready();
    };
  }
}
