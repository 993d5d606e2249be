// The view's environment: background, light, floor grid, a stand; it belongs to the page and not to the scene.
import { boxOf } from "./camera.js";

const THEMES = {
  light: { background: 0xe9edf1, grid: 0xc3ccd5, ground: 0.16, light: 1 },
  dark: { background: 0x171b20, grid: 0x333c46, ground: 0.45, light: 0.78 },
};

export const GRID_CELL = 0.25; // [m]
const MIN_GAP = 0.01; // [m] between the arm's base and the floor, from which on a stand is drawn

/**
 * Add it to meshcat's viewer; returns {setFloor(height), placeStand(), stand}: the second is called when the arm has been
 * drawn anew.
 * @param {MeshCatViewer} viewer
 */
export function createEnvironment(viewer) {
  const { THREE } = globalThis.MeshCat;
  for (const name of ["Lights", "Grid", "Axes"]) viewer.set_property([name], "visible", false);
  const group = new THREE.Group();
  viewer.scene.add(group);
  const lights = addLights(group);
  const grid = createGrid();
  const ground = new THREE.Mesh(new THREE.PlaneGeometry(8, 8), new THREE.ShadowMaterial());
  ground.receiveShadow = true;
  ground.position.z = 0.001;
  const stand = createStand();
  group.add(grid, ground, stand);

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => {
    const theme = THEMES[dark.matches ? "dark" : "light"];
    viewer.scene.background = new THREE.Color(theme.background);
    viewer.scene.fog = new THREE.Fog(theme.background, 5, 12);
    for (const [light, intensity] of lights) light.intensity = intensity * theme.light;
    grid.material.color.setHex(theme.grid);
    ground.material.opacity = theme.ground;
    stand.material.color.setHex(theme.grid);
    viewer.set_dirty();
  };
  dark.addEventListener("change", paint);
  paint();
  /** @param {number} height of the chosen scene's floor [m] */
  const setFloor = (height) => {
    grid.position.z = height;
    ground.position.z = height + 0.001;
    placeStand();
    viewer.set_dirty();
  };
  const placeStand = () => {
    const box = boxOf(viewer.scene_tree.children.robot?.children.link0);
    const gap = box.min.y - grid.position.z;
    stand.visible = !box.isEmpty() && gap > MIN_GAP;
    if (!stand.visible) return;
    const size = box.getSize(new THREE.Vector3());
    const middle = viewer.scene.worldToLocal(box.getCenter(new THREE.Vector3()));
    stand.scale.set(size.x / 2, size.z / 2, gap);
    stand.position.set(middle.x, middle.y, grid.position.z + gap / 2);
  };
  return { setFloor, placeStand, stand };
}

/**
 * Returns [light, intensity in the light theme] of each.
 * @param {THREE.Group} group
 * @returns {[THREE.Light, number][]}
 */
function addLights(group) {
  const { THREE } = globalThis.MeshCat;
  const sky = new THREE.HemisphereLight(0xffffff, 0xb9c0c8);
  const sun = new THREE.DirectionalLight(0xffffff);
  const fill = new THREE.DirectionalLight(0xdfe8ff);
  sun.position.set(1.6, -2.2, 4.0);
  fill.position.set(-2.5, 2.0, 1.5);
  sun.castShadow = true;
  sun.shadow.mapSize.set(2048, 2048);
  sun.shadow.bias = -0.0006;
  sun.shadow.normalBias = 0.01;
  sun.shadow.radius = 3;
  Object.assign(sun.shadow.camera, { left: -2, right: 2, top: 2, bottom: -2, near: 1, far: 9 });
  group.add(sky, sun, sun.target, fill);
  return [
    [sky, 0.66],
    [sun, 0.5],
    [fill, 0.22],
  ];
}

// One segment a cell: long lines that pass behind the camera vanish in some software renderers.
function createGrid(cells = 16, size = GRID_CELL) {
  const { THREE } = globalThis.MeshCat;
  /** @type {number[]} */
  const points = [];
  const half = (cells * size) / 2;
  for (let i = 0; i <= cells; i++) {
    for (let j = 0; j < cells; j++) {
      const [a, b, c] = [i * size - half, j * size - half, (j + 1) * size - half];
      points.push(a, b, 0, a, c, 0, b, a, 0, c, a, 0);
    }
  }
  const geometry = new THREE.BufferGeometry();
  geometry.setAttribute("position", new THREE.Float32BufferAttribute(points, 3));
  return new THREE.LineSegments(geometry, new THREE.LineBasicMaterial());
}

/** A pale column under an arm whose base is above the floor: nobody has said what it stands on, and nothing is checked there. */
function createStand() {
  const { THREE } = globalThis.MeshCat;
  const geometry = new THREE.CylinderGeometry(1, 1, 1, 32).rotateX(Math.PI / 2);
  const material = new THREE.MeshLambertMaterial({ transparent: true, opacity: 0.55 });
  return new THREE.Mesh(geometry, material);
}
