// Which polygon holds a place: the nearest centres are looked up in boxes of space, then asked one after another.

const CANDIDATES = 12;

/** Whether a ring of corners `first` to `end`, which `flat` brings to [x, y], goes round zero. */
export function goesRound(first, end, flat) {
  let round = false;
  let [ax, ay] = flat(end - 1);
  for (let k = first; k < end; k++) {
    const [bx, by] = flat(k);
    if (ay > 0 !== by > 0 && ax + ((bx - ax) * -ay) / (by - ay) > 0) round = !round;
    [ax, ay] = [bx, by];
  }
  return round;
}

export class Picker {
  /** `centres` are points within the polygons; `closed` where these cover the surface. */
  constructor(surface, rings, centres, closed) {
    Object.assign(this, { surface, rings, centres, closed });
    const count = centres.length / 3;
    this.width = Math.max(2, Math.floor(Math.sqrt(count / 12)));
    const boxes = this.width ** 3;
    this.boxes = new Map();
    for (let i = 0; i < count; i++) {
      const key = this.key(...[0, 1, 2].map((axis) => this.box(centres[3 * i + axis], axis)));
      if (!this.boxes.has(key)) this.boxes.set(key, []);
      this.boxes.get(key).push(i);
    }
    this.farthest = boxes > 1 ? this.width : 1;
  }

  box(value, axis) {
    const share = (value - this.surface.low[axis]) / this.surface.size;
    return Math.min(this.width - 1, Math.max(0, Math.floor(share * this.width)));
  }

  key(i, j, k) {
    return i + this.width * (j + this.width * k);
  }

  /** Number of the polygon that a camera sees at a place; -1 where there is none. */
  at(place, camera) {
    const { surface } = this;
    const points = surface.images(place);
    for (const point of points) {
      const found = this.nearest(point).find((number) => surface.holds(this.rings, number, this.centre(number), point));
      if (found !== undefined) return surface.draws(this.rings, found, this.centre(found), point, place, camera) ? found : -1;
    }
    // Between the polygons of a closed surface there is nothing but round-off.
    return this.closed ? (this.nearest(points[0])[0] ?? -1) : -1;
  }

  /** The nearest centres, the nearest first. */
  nearest(point) {
    const middle = point.map((value, axis) => this.box(value, axis));
    const side = this.surface.size / this.width;
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

  centre(number) {
    return this.centres.subarray(3 * number, 3 * number + 3);
  }
}
