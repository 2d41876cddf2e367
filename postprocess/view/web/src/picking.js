// Which polygon holds a place: the nearest centres are looked up in boxes of space, then asked one after another.

const CANDIDATES = 12;

export class Picker {
  /** `centres` are unit vectors within the polygons; `closed` where these cover the sphere. */
  constructor(points, rings, centres, closed) {
    Object.assign(this, { points, rings, centres, closed });
    const count = centres.length / 3;
    this.width = Math.max(2, Math.floor(Math.sqrt(count / 12)));
    const boxes = this.width ** 3;
    this.boxes = new Map();
    for (let i = 0; i < count; i++) {
      const key = this.key(...[0, 1, 2].map((axis) => this.box(centres[3 * i + axis])));
      if (!this.boxes.has(key)) this.boxes.set(key, []);
      this.boxes.get(key).push(i);
    }
    this.farthest = boxes > 1 ? this.width : 1;
  }

  box(value) {
    return Math.min(this.width - 1, Math.max(0, Math.floor(((value + 1) / 2) * this.width)));
  }

  key(i, j, k) {
    return i + this.width * (j + this.width * k);
  }

  /** Number of the polygon at a unit vector; -1 where there is none. */
  at(point) {
    const near = this.nearest(point);
    const found = near.find((number) => this.holds(number, point));
    if (found !== undefined) return found;
    return this.closed && near.length ? near[0] : -1;
  }

  /** The nearest centres, the nearest first. */
  nearest(point) {
    const middle = point.map((value) => this.box(value));
    const side = 2 / this.width;
    let found = [];
    for (let reach = 1; reach <= this.farthest; reach = 2 * reach) {
      found = this.within(middle, reach).map((number) => ({ number, distance: this.distance(number, point) }));
      found.sort((a, b) => a.distance - b.distance);
      // What lies beyond the boxes looked into is further away than `reach` of their sides.
      if (found.length >= 3 && found[2].distance <= reach * side) break;
    }
    return found.slice(0, CANDIDATES).map(({ number }) => number);
  }

  within([i, j, k], reach) {
    const range = (at) => [Math.max(0, at - reach), Math.min(this.width - 1, at + reach)];
    const [[i0, i1], [j0, j1], [k0, k1]] = [range(i), range(j), range(k)];
    const found = [];
    for (let c = k0; c <= k1; c++)
      for (let b = j0; b <= j1; b++)
        for (let a = i0; a <= i1; a++) found.push(...(this.boxes.get(this.key(a, b, c)) ?? []));
    return found;
  }

  distance(number, [x, y, z]) {
    const { centres } = this;
    return Math.hypot(centres[3 * number] - x, centres[3 * number + 1] - y, centres[3 * number + 2] - z);
  }

  /** Whether the sides of a polygon, seen from the middle of the sphere, go round a point. */
  holds(number, [x, y, z]) {
    const { starts, rings } = this.rings;
    const { xyz } = this.points;
    if (this.distance(number, [x, y, z]) > 1) return false;
    // Any two directions across the point's own.
    const across = Math.abs(z) < 0.9 ? [-y, x, 0] : [0, -z, y];
    const other = [y * across[2] - z * across[1], z * across[0] - x * across[2], x * across[1] - y * across[0]];
    let turned = false;
    const flat = (k) => {
      const [px, py, pz] = xyz.subarray(3 * rings[k], 3 * rings[k] + 3);
      const depth = px * x + py * y + pz * z;
      return [(px * across[0] + py * across[1] + pz * across[2]) / depth, (px * other[0] + py * other[1] + pz * other[2]) / depth];
    };
    let [ax, ay] = flat(starts[number + 1] - 1);
    for (let k = starts[number]; k < starts[number + 1]; k++) {
      const [bx, by] = flat(k);
      if (ay > 0 !== by > 0 && ax + ((bx - ax) * -ay) / (by - ay) > 0) turned = !turned;
      [ax, ay] = [bx, by];
    }
    return turned;
  }
}
