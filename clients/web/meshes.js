// What the 3-D view's ways and bodies look like, as objects of three.js in robot coordinates [m].
import { distance, even, sampled, stretch } from "./polyline.js";
import { tube } from "./tube_geometry.js";

// One colour a way, the same as --way-0 ... in the style sheet (Okabe & Ito's palette for all eyes).
export const WAYS = [0x0072b2, 0xd55e00, 0x009e73, 0xcc79a7, 0xe69f00, 0x56b4e9];
export const wayColor = (cluster) => WAYS[(cluster - 1) % WAYS.length];

const GREY = 0x7a8694;
const RED = 0xd62718;

function paint(color, opacity = 1) {
  const { THREE } = globalThis.MeshCat;
  return new THREE.MeshPhongMaterial({ color, opacity, transparent: opacity < 1, depthWrite: opacity === 1, shininess: 28, specular: 0x2a2a2a });
}

const GEOMETRIES = {
  box: (THREE, { size }) => new THREE.BoxGeometry(...size),
  cylinder: (THREE, { size }) => new THREE.CylinderGeometry(size[0], size[0], size[1], 48).rotateX(Math.PI / 2),
  sphere: (THREE, { size }) => new THREE.SphereGeometry(size[0], 32, 24),
  mesh: (THREE, { size, vertices }) => {
    const geometry = new THREE.BufferGeometry().setFromPoints(vertices.map((p) => new THREE.Vector3(...p).multiplyScalar(size[0])));
    geometry.computeVertexNormals(); // three corners a face, none shared: sharp edges
    return geometry;
  },
};

export function solid(shape) {
  const { THREE } = globalThis.MeshCat;
  const mesh = new THREE.Mesh(GEOMETRIES[shape.kind](THREE, shape), paint(shape.color));
  mesh.position.set(...shape.position);
  const [w, x, y, z] = shape.orientation;
  mesh.quaternion.set(x, y, z, w);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

export function line(points, cluster) {
  const { THREE } = globalThis.MeshCat;
  const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3(...p)));
  return new THREE.Line(geometry, new THREE.LineBasicMaterial({ color: cluster ? wayColor(cluster) : GREY, opacity: cluster ? 0.75 : 1, transparent: Boolean(cluster) }));
}

// Neighbours that coincide have no direction.
const apart = (points) => points.filter((point, i) => !i || distance(point, points[i - 1]) > 1e-5);

function mesh(points, radius, material) {
  const { THREE } = globalThis.MeshCat;
  const made = new THREE.Mesh(tube(points, radius), material);
  made.castShadow = material.opacity === 1;
  return made;
}

// Seen through what stands before it: what is pointed at must not be hidden by an obstacle.
function over(made) {
  made.material.depthTest = false;
  made.material.transparent = true; // drawn after all that is solid
  made.renderOrder = made.material.color.getHex() === RED ? 2 : 1;
  made.castShadow = false;
  return made;
}

export const way = (path) => mesh(sampled(path.curve), 0.005, paint(wayColor(path.cluster)));
export const departure = (course, share) => over(mesh(stretch(apart(course), share), 0.0032, paint(RED)));
export const marked = (course, cluster) => over(mesh(apart(course), 0.0025, paint(cluster ? wayColor(cluster) : GREY)));

export function spreadTube(path, spread) {
  const around = mesh(even(sampled(path.curve), spread.length), spread.map((radius) => Math.max(radius, 0.0005)), paint(wayColor(path.cluster), 0.22));
  around.material.side = globalThis.MeshCat.THREE.DoubleSide;
  return around;
}
