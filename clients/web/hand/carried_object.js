// What the operator carries, drawn: the object, its shadow on what lies below, and a stem between the two that makes
// the height readable.
const FREE = 0xe8c547;
const HELD = 0xe08a00;
const WRONG = 0xb3391f;

export class Prop {
  // `easel` as in overlay.js; `shape` the carried object of the scene.
  constructor(easel, shape) {
    const { THREE } = easel;
    this.easel = easel;
    this.group = new THREE.Group();
    const material = new THREE.MeshLambertMaterial({ color: FREE });
    this.body = new THREE.Mesh(solid(THREE, shape), material);
    this.body.castShadow = true;
    const dark = { color: 0x101418, transparent: true, depthWrite: false };
    this.disc = new THREE.Mesh(new THREE.CircleGeometry(Math.max(...shape.size) * 0.75, 32), new THREE.MeshBasicMaterial({ ...dark, opacity: 0.35 }));
    const line = new THREE.BufferGeometry().setFromPoints([new THREE.Vector3(), new THREE.Vector3(0, 0, 1)]);
    this.stem = new THREE.Line(line, new THREE.LineBasicMaterial({ color: 0x5a6672 }));
    this.group.add(this.body, this.disc, this.stem);
    easel.group.add(this.group);
  }

  // Show it at a place above `below` [m]; `wrong` when it is in an obstacle.
  place([x, y, z], below, { grasped, wrong }) {
    this.body.position.set(x, y, z);
    this.disc.position.set(x, y, below + 0.002);
    this.stem.position.set(x, y, below);
    this.stem.scale.z = Math.max(1e-4, z - below);
    this.body.material.color.setHex(wrong ? WRONG : grasped ? HELD : FREE);
    this.easel.dirty();
  }

  // Turn it as the hand that holds it has turned, {position, turn}; null: upright. Returns the position.
  turn(held) {
    this.body.quaternion.copy(held?.turn ?? new this.easel.THREE.Quaternion());
    return held?.position;
  }

  remove() {
    this.easel.group.remove(this.group);
    for (const mesh of [this.body, this.disc, this.stem]) {
      mesh.geometry.dispose();
      mesh.material.dispose();
    }
    this.easel.dirty();
  }
}

export function solid(THREE, { kind, size }) {
  if (kind === "sphere") return new THREE.SphereGeometry(size[0], 24, 16);
  if (kind !== "cylinder") return new THREE.BoxGeometry(...size);
  const upright = new THREE.CylinderGeometry(size[0], size[0], size[1], 32);
  upright.rotateX(Math.PI / 2);
  return upright;
}
