// What the page uses of meshcat's viewer (meshcat.min.js), which brings three.js along.
interface MeshCatNode {
  object: THREE.Object3D;
  children: Record<string, MeshCatNode>;
}

interface MeshCatViewer {
  scene: THREE.Scene;
  camera: THREE.PerspectiveCamera;
  renderer: THREE.WebGLRenderer;
  controls: THREE.EventDispatcher & { enabled: boolean; target: THREE.Vector3; update(): void };
  scene_tree: MeshCatNode;
  gui: { domElement: HTMLElement };
  set_dirty(): void;
  set_object(path: string[], object: THREE.Object3D): void;
  set_property(path: string[], property: string, value: unknown): void;
  delete_path(path: string[]): void;
  handle_command_bytearray(bytes: Uint8Array): void;
  set_3d_pane_size(width?: number, height?: number): void;
  render(): void;
}

declare var MeshCat: { Viewer: new (element: HTMLElement) => MeshCatViewer; THREE: typeof THREE };
