// Round tubes along a polyline: their vertices as arrays, and a geometry of three.js that is rewritten in place.
const SIDES = 8;

/** A tube with a ring of vertices for each of `count` points. */
export class TubeGeometry {
  /** @param {number} count */
  constructor(count) {
    const { THREE } = globalThis.MeshCat;
    this.count = count;
    this.geometry = new THREE.BufferGeometry();
    for (const name of ["position", "normal"]) {
      const attribute = new THREE.BufferAttribute(new Float32Array(3 * count * SIDES), 3);
      this.geometry.setAttribute(name, attribute.setUsage(THREE.DynamicDrawUsage));
    }
    this.geometry.setIndex(tubeIndices(count));
    this.geometry.boundingSphere = new THREE.Sphere(new THREE.Vector3(), 1e3); // never culled, never computed again
  }

  /**
   * @param {ArrayLike<number>} points x, y, z after x, y, z [m]
   * @param {number | number[]} radius [m] one, or one for each point
   */
  setPath(points, radius) {
    const { position, normal } = this.geometry.attributes;
    writeTube(points, radius, floats(position), floats(normal));
    position.needsUpdate = normal.needsUpdate = true;
  }

  /**
   * Colour the tube, for a material with vertexColors.
   * @param {(i: number, out: number[]) => void} color writes red, green and blue (0 to 1) of point i into `out`
   */
  setColors(color) {
    const { attributes } = this.geometry;
    if (!attributes.color) {
      const { THREE } = globalThis.MeshCat;
      this.geometry.setAttribute("color", new THREE.BufferAttribute(new Float32Array(3 * this.count * SIDES), 3));
    }
    const out = [1, 1, 1];
    for (let i = 0; i < this.count; i++) {
      color(i, out);
      for (let side = 0; side < SIDES; side++) floats(attributes.color).set(out, 3 * (i * SIDES + side));
    }
    attributes.color.needsUpdate = true;
  }
}

/** @param {THREE.BufferAttribute | THREE.InterleavedBufferAttribute} attribute */
const floats = (attribute) => /** @type {Float32Array} */ (attribute.array);

/** @typedef {Float64Array | Float32Array} Floats */

/**
 * Write positions and normals of the rings. Each ring's frame is the one before, reflected twice, so that the tube is not
 * twisted (Wang et al., ACM Transactions on Graphics 27(1), 2008).
 * @param {ArrayLike<number>} points
 * @param {number | number[]} radius
 * @param {Floats} positions
 * @param {Floats} normals
 */
export function writeTube(points, radius, positions, normals) {
  const count = points.length / 3;
  const tangent = tangentAt(points, 0, new Float64Array([1, 0, 0]));
  const normal = perpendicular(tangent);
  const [step, next, binormal] = [new Float64Array(3), new Float64Array(3), new Float64Array(3)];
  for (let i = 0; i < count; i++) {
    if (i > 0) {
      for (let k = 0; k < 3; k++) step[k] = points[3 * i + k] - points[3 * i - 3 + k];
      next.set(tangent);
      tangentAt(points, i, next);
      reflect(normal, step);
      reflect(tangent, step);
      for (let k = 0; k < 3; k++) step[k] = next[k] - tangent[k];
      reflect(normal, step);
      tangent.set(next);
    }
    cross(tangent, normal, binormal);
    writeRing(i, points, [normal, binormal], Array.isArray(radius) ? radius[i] : radius, positions, normals);
  }
}

/**
 * Indices of the triangles between `count` rings.
 * @param {number} count
 */
export function tubeIndices(count) {
  /** @type {number[]} */
  const indices = [];
  for (let i = 0; i + 1 < count; i++) {
    for (let k = 0; k < SIDES; k++) {
      const [a, b] = [i * SIDES + k, i * SIDES + ((k + 1) % SIDES)];
      indices.push(a, b, a + SIDES, b, b + SIDES, a + SIDES);
    }
  }
  return indices;
}

/**
 * @param {number} i
 * @param {ArrayLike<number>} points
 * @param {Float64Array[]} frame normal and binormal
 * @param {number} radius
 * @param {Floats} positions
 * @param {Floats} normals
 */
function writeRing(i, points, [normal, binormal], radius, positions, normals) {
  for (let side = 0; side < SIDES; side++) {
    const angle = (2 * Math.PI * side) / SIDES;
    const [c, s] = [Math.cos(angle), Math.sin(angle)];
    const at = 3 * (i * SIDES + side);
    for (let k = 0; k < 3; k++) {
      normals[at + k] = c * normal[k] + s * binormal[k];
      positions[at + k] = points[3 * i + k] + radius * normals[at + k];
    }
  }
}

/**
 * Write the direction of the polyline at a point; where its neighbours coincide, `out` stays as it is.
 * @param {ArrayLike<number>} points
 * @param {number} i
 * @param {Float64Array} out
 */
function tangentAt(points, i, out) {
  const [before, after] = [3 * Math.max(0, i - 1), 3 * Math.min(points.length / 3 - 1, i + 1)];
  const [x, y, z] = [0, 1, 2].map((k) => points[after + k] - points[before + k]);
  const length = Math.hypot(x, y, z);
  if (length > 1e-12) out.set([x / length, y / length, z / length]);
  return out;
}

/**
 * A unit vector across a tangent.
 * @param {Float64Array} tangent
 */
function perpendicular(tangent) {
  const axis = Math.abs(tangent[2]) < 0.9 ? [0, 0, 1] : [1, 0, 0];
  const normal = cross(tangent, axis, new Float64Array(3));
  const length = Math.hypot(...normal);
  return normal.map((value) => value / length);
}

/**
 * Mirror a vector in place at the plane that `axis` is perpendicular to; a zero axis mirrors nothing.
 * @param {Float64Array} vector
 * @param {Float64Array} axis
 */
function reflect(vector, axis) {
  const squared = axis[0] ** 2 + axis[1] ** 2 + axis[2] ** 2;
  if (squared < 1e-24) return;
  const scale = (-2 * (axis[0] * vector[0] + axis[1] * vector[1] + axis[2] * vector[2])) / squared;
  for (let k = 0; k < 3; k++) vector[k] += scale * axis[k];
}

/** @param {ArrayLike<number>} a @param {ArrayLike<number>} b @param {Float64Array} out */
function cross(a, b, out) {
  for (let k = 0; k < 3; k++) {
    const [i, j] = [(k + 1) % 3, (k + 2) % 3];
    out[k] = a[i] * b[j] - a[j] * b[i];
  }
  return out;
}
