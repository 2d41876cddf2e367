// Triangles that fill polygons on the sphere: a fan round the middle of each, so that shaders know the way to its rim.

import { aboutZero, mollweideAngle } from "./projections.js";

const LONG_ARC = 0.12; // radians: longer sides are drawn as several pieces
const PIECE = 0.06;
const MOST_PIECES = 64;
const WIDE = 0.17; // radians of longitude: wider polygons lie near a pole, and have no corners in common on the map

/** Into how many pieces a side is cut: the same seen from both of its polygons. */
function pieces(points, a, b) {
  const apart = Math.abs(aboutZero(points.lon[a] - points.lon[b]));
  const { xyz } = points;
  const chord = Math.hypot(xyz[3 * a] - xyz[3 * b], xyz[3 * a + 1] - xyz[3 * b + 1], xyz[3 * a + 2] - xyz[3 * b + 2]);
  if (apart < LONG_ARC && chord < LONG_ARC) return 1;
  return Math.min(MOST_PIECES, Math.ceil(Math.max(apart, chord) / PIECE));
}

function holdsPole(corners, pole) {
  return corners.every(([ax, ay], i) => {
    const [bx, by] = corners[(i + 1) % corners.length];
    return pole * (ax * by - ay * bx) > 0;
  });
}

/** Corners of one polygon as [x, y, z, lon, lat], long sides cut into pieces. */
function outline(points, rings, start, end) {
  const corners = [];
  for (let k = start; k < end; k++) {
    const a = rings[k];
    const b = rings[k + 1 < end ? k + 1 : start];
    const [x, y, z] = points.xyz.subarray(3 * a, 3 * a + 3);
    corners.push([x, y, z, points.lon[a], points.lat[a]]);
    const count = pieces(points, a, b);
    for (let i = 1; i < count; i++) {
      const share = i / count;
      corners.push(unit([0, 1, 2].map((axis) => (1 - share) * points.xyz[3 * a + axis] + share * points.xyz[3 * b + axis])));
    }
  }
  return corners;
}

function unit([x, y, z]) {
  const length = Math.hypot(x, y, z);
  return [x / length, y / length, z / length, Math.atan2(y, x), Math.asin(z / length)];
}

function middle(corners) {
  const sum = [0, 0, 0];
  for (const corner of corners) for (let axis = 0; axis < 3; axis++) sum[axis] += corner[axis];
  return unit(sum);
}

/** Grows as numbers are added. */
class Numbers {
  constructor(Kind, size) {
    this.array = new Kind(size);
    this.length = 0;
  }

  add(...values) {
    if (this.length + values.length > this.array.length) {
      const longer = new this.array.constructor(2 * this.array.length + values.length);
      longer.set(this.array);
      this.array = longer;
    }
    for (const value of values) this.array[this.length++] = value;
  }

  get filled() {
    return this.array.subarray(0, this.length);
  }
}

/**
 * Corners of the fans of all polygons: `position` (3 each) on the sphere; `onMap` (4 each) longitude, cosine and sine
 * of Mollweide's angle, and the longitude of the polygon; `part` (2 each) the number of the polygon, and 1 in the
 * middle, 0 on the rim; `index` three corners for each triangle. `centres` (3 for each polygon) lie within.
 */
export function fansOf(points, { starts, rings, count }) {
  const guess = 8 * count;
  const fans = { position: new Numbers(Float32Array, 3 * guess), onMap: new Numbers(Float32Array, 4 * guess), part: new Numbers(Float32Array, 2 * guess), index: new Numbers(Uint32Array, 18 * count) };
  const centres = new Float64Array(3 * count);
  let corner = 0;
  const add = ([x, y, z, lon, lat], number, within, longitude) => {
    const angle = mollweideAngle(lat);
    fans.position.add(x, y, z);
    fans.onMap.add(longitude + aboutZero(lon - longitude), Math.cos(angle), Math.sin(angle), longitude);
    fans.part.add(number, within);
    return corner++;
  };
  for (let number = 0; number < count; number++) {
    const ring = outline(points, rings, starts[number], starts[number + 1]);
    const centre = middle(ring);
    for (let axis = 0; axis < 3; axis++) centres[3 * number + axis] = centre[axis];
    const pole = Math.sign(centre[2]);
    const polar = Math.abs(centre[2]) > 0.7 && holdsPole(ring, pole);
    const hub = polar ? [0, 0, pole, 0, (pole * Math.PI) / 2] : centre;
    if (!polar && ring.every((each) => Math.abs(aboutZero(each[3] - hub[3])) < WIDE)) {
      const first = add(hub, number, 1, hub[3]);
      for (const each of ring) add(each, number, 0, hub[3]);
      for (let k = 0; k < ring.length; k++) fans.index.add(first, first + 1 + k, first + 1 + ((k + 1) % ring.length));
    } else {
      ring.forEach((each, k) => {
        const next = ring[(k + 1) % ring.length];
        const longitude = each[3] + aboutZero(next[3] - each[3]) / 2;
        const ends = [polar ? [hub[0], hub[1], hub[2], longitude, hub[4]] : hub, each, next];
        fans.index.add(...ends.map((end, which) => add(end, number, which === 0 ? 1 : 0, longitude)));
      });
    }
  }
  return { position: fans.position.filled, onMap: fans.onMap.filled, part: fans.part.filled, index: fans.index.filled, centres };
}
