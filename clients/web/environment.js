// The view's environment: background, light, floor grid and camera; it belongs to the page and not to the scene.
const THEMES = {
  light: { background: 0xe9edf1, grid: 0xc3ccd5, ground: 0.16, light: 1 },
  dark: { background: 0x171b20, grid: 0x333c46, ground: 0.45, light: 0.78 },
};

/**
 * Add it to meshcat's viewer; returns {fitCamera(), setFloor(height)}: the first puts the camera to its home.
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
  group.add(grid, ground);

  const dark = matchMedia("(prefers-color-scheme: dark)");
  const paint = () => {
    const theme = THEMES[dark.matches ? "dark" : "light"];
    viewer.scene.background = new THREE.Color(theme.background);
    viewer.scene.fog = new THREE.Fog(theme.background, 5, 12);
    for (const [light, intensity] of lights) light.intensity = intensity * theme.light;
    grid.material.color.setHex(theme.grid);
    ground.material.opacity = theme.ground;
    viewer.set_dirty();
  };
  dark.addEventListener("change", paint);
  paint();
  /** @param {number} height of the chosen scene's floor [m] */
  const setFloor = (height) => {
    grid.position.z = height;
    ground.position.z = height + 0.001;
    viewer.set_dirty();
  };
  return { fitCamera: () => fitCamera(viewer), setFloor };
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
function createGrid(cells = 16, size = 0.25) {
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

/**
 * Fit the scene and the arm's workspace into the view, seen from the free side of the table, a little from above.
 * @param {MeshCatViewer} viewer
 */
function fitCamera(viewer) {
  const { THREE } = globalThis.MeshCat;
  const { camera } = viewer;
  camera.fov = 30;
  const tall = Math.tan((camera.fov * Math.PI) / 360);
  const wide = tall * camera.aspect;
  const ahead = new THREE.Vector3(0.7, 0.47, 0.7).normalize(); // three's frame: x forward of the arm, y up, z its right
  const right = new THREE.Vector3(0, 1, 0).cross(ahead).normalize();
  const up = ahead.clone().cross(right);
  const target = new THREE.Vector3();
  const corners = boxes(viewer).flatMap((box) => cornersOf(box));
  let distance = 0;
  for (let round = 0; round < 4; round++) {
    const relative = corners.map((corner) => corner.clone().sub(target));
    const seen = relative.map((p) => ({ x: p.dot(right), y: p.dot(up), z: p.dot(ahead) }));
    distance = 1.05 * Math.max(...seen.map((p) => p.z + Math.max(Math.abs(p.x) / wide, Math.abs(p.y) / tall)));
    const [x, y] = [middle(seen.map((p) => p.x / (distance - p.z))), middle(seen.map((p) => p.y / (distance - p.z)))];
    target.addScaledVector(right, x * distance).addScaledVector(up, y * distance);
  }
  camera.position.copy(target).addScaledVector(ahead, distance);
  viewer.controls.target.copy(target);
  viewer.controls.update();
  camera.updateProjectionMatrix();
  viewer.set_dirty();
}

/**
 * What the camera is fitted to, in three's frame. The arm's own box would jump with its pose: a column of its usual height
 * stands for it.
 * @param {MeshCatViewer} viewer
 */
function boxes(viewer) {
  const { THREE } = globalThis.MeshCat;
  const found = [new THREE.Box3(new THREE.Vector3(-0.25, 0, -0.25), new THREE.Vector3(0.25, 1.15, 0.25))];
  for (const name of ["scene", "paths"]) {
    const box = new THREE.Box3();
    const node = viewer.scene_tree.children[name];
    if (node) box.expandByObject(node.object);
    if (!box.isEmpty()) found.push(box);
  }
  return found;
}

/** @param {THREE.Box3} box */
function cornersOf({ min, max }) {
  const { THREE } = globalThis.MeshCat;
  const [xs, ys, zs] = [
    [min.x, max.x],
    [min.y, max.y],
    [min.z, max.z],
  ];
  return xs.flatMap((x) => ys.flatMap((y) => zs.map((z) => new THREE.Vector3(x, y, z))));
}

/** @param {number[]} values */
const middle = (values) => (Math.max(...values) + Math.min(...values)) / 2;
