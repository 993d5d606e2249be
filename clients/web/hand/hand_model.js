// The hand as the page moves it: it follows what the operator points at, never faster than a hand, never into the table.
const FASTEST = 1.2; // [m/s] a recorder takes a faster step for a jump of the tracker
const LONGEST = 0.03; // [s] that one step makes good after a stall: more would be a leap
const LAG = 0.04; // [s] in which the hand follows, so that the steps of a mouse are no corners of the path
const NEAR = 0.004; // [m] at which it counts as arrived

export class Carry {
  grasped = false;
  tracked = true;

  // `scene` as the service describes it: obstacles, and `carried`, the object at its start.
  constructor(scene) {
    this.scene = scene;
    this.home = [...scene.carried.position];
    this.position = [...this.home];
    this.target = [...this.home];
    this.half = halfHeight(scene.carried);
  }

  get isHome() {
    return distance(this.position, this.home) < NEAR;
  }

  get travelled() {
    return distance(this.position, this.home);
  }

  // Point at a place; z stays above what is below it.
  aim([x, y, z]) {
    const reach = (value, limit) => Math.min(limit, Math.max(-limit, value));
    const [u, v] = [reach(x, 1.4), reach(y, 1.4)];
    this.target = [u, v, Math.min(2, Math.max(z, this.support([u, v]) + this.half))];
  }

  goHome() {
    this.grasped = false;
    this.target = [...this.home];
  }

  // Advance by the seconds since the last step; true when the hand has moved.
  step(elapsed) {
    const seconds = Math.min(elapsed, LONGEST);
    const share = 1 - Math.exp(-seconds / LAG);
    const wish = this.target.map((value, i) => (value - this.position[i]) * share);
    const far = Math.hypot(...wish);
    const scale = far > FASTEST * seconds ? (FASTEST * seconds) / far : 1;
    this.position = this.position.map((value, i) => value + wish[i] * scale);
    return far > 1e-6;
  }

  // Height of the table under a place, or of the floor: what the object cannot be pushed into.
  support([x, y]) {
    const table = this.scene.obstacles.find((shape) => shape.name === "table");
    return table && covers(table, x, y) ? top(table) : 0;
  }

  // Height of whatever lies under the object, for its shadow.
  below([x, y, z]) {
    const under = this.scene.obstacles.filter((shape) => covers(shape, x, y) && top(shape) <= z + 0.001);
    return Math.max(0, ...under.map(top));
  }

  // Name of the obstacle that the object is in, or "".
  touches([x, y, z]) {
    const side = this.scene.carried.size[0] / 2;
    const hit = this.scene.obstacles.find(
      (shape) => shape.name !== "table" && covers(shape, x, y, side) && z - this.half < top(shape) && z + this.half > bottom(shape),
    );
    return hit?.name ?? "";
  }
}

const distance = (a, b) => Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]);
const halfHeight = (shape) => (shape.kind === "cylinder" ? shape.size[1] : (shape.size[2] ?? shape.size[0])) / 2;
const top = (shape) => shape.position[2] + halfHeight(shape);
const bottom = (shape) => shape.position[2] - halfHeight(shape);

function covers(shape, x, y, margin = 0) {
  const [dx, dy] = [Math.abs(x - shape.position[0]), Math.abs(y - shape.position[1])];
  if (shape.kind === "cylinder") return Math.hypot(dx, dy) < shape.size[0] + margin;
  return dx < shape.size[0] / 2 + margin && dy < shape.size[1] / 2 + margin;
}
