// The camera of the view: its home, standard views, and turns and zooms about what it looks at. Directions are three's:
// x forward of the arm, y up, z its right.

const MARGIN = 1.05; // of the picture around what it is fitted to
const MAX_FOOT = 1 / 3; // of the view that its controls may take from what is fitted
const [HIGHEST, LOWEST] = [0.01, 1.75]; // [rad] from straight above
const COLUMN = { radius: 0.25, height: 1.15 }; // [m] that stands for the arm, whose own box would jump with its pose

/** Where the camera stands, seen from what it looks at. @type {Record<string, number[]>} */
export const VIEWPOINTS = { home: [0.7, 0.47, 0.7], front: [1, 0.02, 0], side: [0, 0.02, 1], top: [0.01, 1, 0] };

/**
 * Fit boxes into the view, above the controls at its foot, seen from a direction: those of the scene and the arm's workspace
 * when none are given.
 * @param {MeshCatViewer} viewer
 * @param {number[]} from a direction, see VIEWPOINTS
 * @param {THREE.Vector3[]} corners of what is to be seen
 */
export function fitCamera(viewer, from = VIEWPOINTS.home, corners = sceneBoxes(viewer).flatMap(cornersOf)) {
  const { THREE } = globalThis.MeshCat;
  const { camera } = viewer;
  camera.fov = 30;
  const tall = Math.tan((camera.fov * Math.PI) / 360);
  const wide = tall * camera.aspect;
  const foot = footShare(viewer.renderer.domElement);
  const ahead = new THREE.Vector3().fromArray(from).normalize();
  const right = new THREE.Vector3(0, 1, 0).cross(ahead).normalize();
  const up = ahead.clone().cross(right);
  const target = new THREE.Vector3();
  let distance = 0;
  for (let round = 0; round < 4; round++) {
    const relative = corners.map((corner) => corner.clone().sub(target));
    const seen = relative.map((p) => ({ x: p.dot(right), y: p.dot(up), z: p.dot(ahead) }));
    const needed = seen.map(({ x, y }) => Math.max(Math.abs(x) / wide, y / tall, -y / (tall * (1 - 2 * foot))));
    distance = MARGIN * Math.max(...seen.map((p, i) => p.z + needed[i]));
    const [x, y] = [middle(seen.map((p) => p.x / (distance - p.z))), middle(seen.map((p) => p.y / (distance - p.z)))];
    target.addScaledVector(right, x * distance).addScaledVector(up, (y - foot * tall) * distance);
  }
  camera.position.copy(target).addScaledVector(ahead, distance);
  viewer.controls.target.copy(target);
  update(viewer);
}

/**
 * Fit points into the view, seen from where the camera is now.
 * @param {MeshCatViewer} viewer
 * @param {Point[]} points in robot coordinates [m]
 */
export function framePoints(viewer, points) {
  const { THREE } = globalThis.MeshCat;
  const corners = points.map((point) => viewer.scene.localToWorld(new THREE.Vector3().fromArray(point)));
  fitCamera(viewer, viewer.camera.position.clone().sub(viewer.controls.target).toArray(), corners);
}

/**
 * Turn the camera about what it looks at, and bring it nearer.
 * @param {MeshCatViewer} viewer
 * @param {{around?: number, over?: number, nearer?: number}} by angles [rad], and a factor
 */
export function moveCamera(viewer, { around = 0, over = 0, nearer = 1 }) {
  const { camera, controls } = viewer;
  const { x, y, z } = camera.position.clone().sub(controls.target);
  const distance = Math.hypot(x, y, z);
  const turn = Math.atan2(x, z) + around;
  const lean = Math.min(LOWEST, Math.max(HIGHEST, Math.acos(y / distance) - over));
  camera.position
    .set(Math.sin(lean) * Math.sin(turn), Math.cos(lean), Math.sin(lean) * Math.cos(turn))
    .multiplyScalar(distance / nearer)
    .add(controls.target);
  update(viewer);
}

/** The share of the view's height that the controls at its foot cover. @param {HTMLElement} canvas */
function footShare(canvas) {
  const controls = canvas.closest(".stage")?.querySelector(".tools");
  const covered = controls ? canvas.getBoundingClientRect().bottom - controls.getBoundingClientRect().top : 0;
  return Math.min(Math.max(covered / Math.max(canvas.clientHeight, 1), 0), MAX_FOOT);
}

/** @param {MeshCatViewer} viewer */
function update(viewer) {
  viewer.controls.update();
  viewer.camera.updateProjectionMatrix();
  viewer.camera.updateMatrixWorld(); // what is projected before the next draw is where it will be seen
  viewer.set_dirty();
}

/** The scene, the paths and the arm's workspace, as high as the arm reaches now. @param {MeshCatViewer} viewer */
function sceneBoxes(viewer) {
  const { THREE } = globalThis.MeshCat;
  const { robot, scene, paths } = viewer.scene_tree.children;
  const height = Math.max(COLUMN.height, boxOf(robot).max.y); // nothing is -Infinity high
  const [low, high] = [new THREE.Vector3(-COLUMN.radius, 0, -COLUMN.radius), new THREE.Vector3()];
  const column = new THREE.Box3(low, high.set(COLUMN.radius, height, COLUMN.radius));
  return [column, ...[scene, paths].map(boxOf).filter((box) => !box.isEmpty())];
}

/** What a part of the tree takes up; empty where there is nothing. @param {MeshCatNode | undefined} node */
export function boxOf(node) {
  const box = new globalThis.MeshCat.THREE.Box3();
  node?.object.updateWorldMatrix(true, false); // it may not have been drawn yet
  return node ? box.expandByObject(node.object) : box;
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
