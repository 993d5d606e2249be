// Builds the 3-D view's shapes, demonstrations and paths as objects of three.js, in robot coordinates [m].
import { distance, resamplePolyline, sampleCurve, slicePolyline } from "./polyline.js";
import { TubeGeometry } from "./tube_geometry.js";
import { wayColor } from "./way_colors.js";

const GREY = 0x7a8694;
const RED = 0xd62718;
const VIOLET = 0x8e44ad; // of what departs; red is for what is forbidden or has failed
const GREEN = 0x2a8f5a;
const BLUE = 0x2f7fbf; // of what is chosen

/** @typedef {{kind: string, size: number[], vertices?: Point[]}} Solid */

/** @param {number} color @param {number} opacity */
export function phongMaterial(color, opacity = 1) {
  const { THREE } = globalThis.MeshCat;
  return new THREE.MeshPhongMaterial({
    color,
    opacity,
    transparent: opacity < 1,
    depthWrite: opacity === 1,
    shininess: 28,
    specular: 0x2a2a2a,
  });
}

/**
 * A geometry of the scene's shape, about its own origin.
 * @param {Solid} shape
 */
export function shapeGeometry({ kind, size, vertices = [] }) {
  const { THREE } = globalThis.MeshCat;
  if (kind === "cylinder") return new THREE.CylinderGeometry(size[0], size[0], size[1], 48).rotateX(Math.PI / 2);
  if (kind === "sphere") return new THREE.SphereGeometry(size[0], 32, 24);
  if (kind === "box") return new THREE.BoxGeometry(size[0], size[1], size[2]);
  const corners = vertices.map((p) => new THREE.Vector3().fromArray(p).multiplyScalar(size[0]));
  const geometry = new THREE.BufferGeometry().setFromPoints(corners);
  geometry.computeVertexNormals(); // three corners a face, none shared: sharp edges
  return geometry;
}

/** @param {Shape} shape @param {number} opacity */
export function shapeMesh(shape, opacity = 1) {
  const { THREE } = globalThis.MeshCat;
  const mesh = placed(new THREE.Mesh(shapeGeometry(shape), phongMaterial(shape.color, opacity)), shape);
  mesh.castShadow = mesh.receiveShadow = true;
  return mesh;
}

/**
 * A zone that the arm keeps out of: one sees through it what is in it.
 * @param {Shape} zone
 */
export function keepOutMesh(zone) {
  const { THREE } = globalThis.MeshCat;
  return placed(new THREE.Mesh(shapeGeometry(zone), phongMaterial(RED, 0.18)), zone);
}

/**
 * The edges of a box that the arm keeps in.
 * @param {Shape} zone
 */
export function keepInEdges(zone) {
  const { THREE } = globalThis.MeshCat;
  const edges = new THREE.EdgesGeometry(shapeGeometry(zone));
  return placed(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: GREEN })), zone);
}

/**
 * The edges of the shape that is chosen, drawn over everything.
 * @param {Shape} shape
 */
export function chosenEdges(shape) {
  const { THREE } = globalThis.MeshCat;
  const edges = new THREE.EdgesGeometry(shapeGeometry(shape), 20);
  const drawn = placed(new THREE.LineSegments(edges, new THREE.LineBasicMaterial({ color: BLUE })), shape);
  drawn.material.depthTest = false;
  drawn.renderOrder = 3;
  return drawn;
}

/**
 * @template {THREE.Object3D} T
 * @param {T} object
 * @param {Shape} shape that says where it is
 * @returns {T}
 */
function placed(object, { position, orientation: [w, x, y, z] }) {
  object.position.fromArray(position);
  object.quaternion.set(x, y, z, w);
  return object;
}

/** @param {Point[]} points @param {number | undefined} cluster */
export function demonstrationLine(points, cluster) {
  const { THREE } = globalThis.MeshCat;
  const geometry = new THREE.BufferGeometry().setFromPoints(points.map((p) => new THREE.Vector3().fromArray(p)));
  const style = cluster ? { color: wayColor(cluster), opacity: 0.75, transparent: true } : { color: GREY };
  return new THREE.Line(geometry, new THREE.LineBasicMaterial(style));
}

/**
 * Without neighbours that coincide: between them there is no direction.
 * @param {Point[]} points
 */
const withoutDuplicates = (points) => points.filter((point, i) => !i || distance(point, points[i - 1]) > 1e-5);

/** @param {Point[]} points @param {number | number[]} radius @param {THREE.Material} material */
function tubeMesh(points, radius, material) {
  const { THREE } = globalThis.MeshCat;
  const tube = new TubeGeometry(points.length);
  tube.setPath(points.flat(), radius);
  const mesh = new THREE.Mesh(tube.geometry, material);
  mesh.castShadow = material.opacity === 1;
  return mesh;
}

/**
 * A tube that is drawn over everything: what is pointed at must not be hidden by an obstacle.
 * @param {Point[]} points
 * @param {number} radius
 * @param {number} color
 */
function tubeOnTop(points, radius, color) {
  const mesh = tubeMesh(points, radius, phongMaterial(color));
  mesh.material.depthTest = false;
  mesh.material.transparent = true; // drawn after all that is opaque
  mesh.renderOrder = color === VIOLET ? 2 : 1;
  mesh.castShadow = false;
  return mesh;
}

/** @param {LearnedPath} path */
export const pathTube = (path) => tubeMesh(sampleCurve(path.curve), 0.005, phongMaterial(wayColor(path.cluster)));

/** @param {Point[]} trajectory @param {number[]} share from where to where it deviates, of its length */
export const deviationTube = (trajectory, share) =>
  tubeOnTop(slicePolyline(withoutDuplicates(trajectory), share), 0.0032, VIOLET);

/** @param {Point[]} trajectory @param {number | undefined} cluster */
export const highlightTube = (trajectory, cluster) =>
  tubeOnTop(withoutDuplicates(trajectory), 0.0025, cluster ? wayColor(cluster) : GREY);

/**
 * A tube around a path, as wide as the demonstrations spread.
 * @param {LearnedPath} path
 * @param {number[]} spread radii [m]
 */
export function spreadTube(path, spread) {
  const radii = spread.map((radius) => Math.max(radius, 0.0005));
  const points = resamplePolyline(sampleCurve(path.curve), spread.length);
  const mesh = tubeMesh(points, radii, phongMaterial(wayColor(path.cluster), 0.22));
  mesh.material.side = globalThis.MeshCat.THREE.DoubleSide;
  return mesh;
}
