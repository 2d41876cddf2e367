// Fans that fill polygons on the sphere, for the globe and for the map.

import { Fans } from "./fans.js";
import { aboutZero, mollweideAngle } from "./projections.js";

const LONG_ARC = 0.12; // radians: longer sides are drawn as several pieces
const PIECE = 0.06;
const MOST_PIECES = 64;
const STRIPS = 12; // of the triangles of wide polygons
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

/** Points as [x, y, z, lon, lat, cosine and sine of Mollweide's angle]. */
function cornersOf({ xyz, lon, lat }) {
  return Array.from(lon, (_, i) => onBoth(xyz[3 * i], xyz[3 * i + 1], xyz[3 * i + 2], lon[i], lat[i]));
}

function onBoth(x, y, z, lon, lat) {
  const angle = mollweideAngle(lat);
  return [x, y, z, lon, lat, Math.cos(angle), Math.sin(angle)];
}

/** Corners of one polygon, long sides cut into pieces. */
function outline(points, corners, rings, start, end) {
  const found = [];
  for (let k = start; k < end; k++) {
    const [a, b] = [rings[k], rings[k + 1 < end ? k + 1 : start]];
    found.push(corners[a]);
    const count = pieces(points, a, b);
    for (let i = 1; i < count; i++) found.push(between(corners[a], corners[b], i / count));
  }
  return found;
}

function between(a, b, share) {
  return unit((1 - share) * a[0] + share * b[0], (1 - share) * a[1] + share * b[1], (1 - share) * a[2] + share * b[2]);
}

function unit(x, y, z) {
  const length = Math.hypot(x, y, z);
  return onBoth(x / length, y / length, z / length, Math.atan2(y, x), Math.asin(Math.min(1, Math.max(-1, z / length))));
}

function middle(corners) {
  let [x, y, z] = [0, 0, 0];
  for (const corner of corners) {
    x += corner[0];
    y += corner[1];
    z += corner[2];
  }
  return unit(x, y, z);
}

/** Add a corner [x, y, z, lon, lat, cosine and sine of Mollweide's angle]; return its number. */
function addCorner(fans, [x, y, z, lon, , cosine, sine], number, within, longitude) {
  const at = fans.corner(number, within);
  const { position, onMap } = fans.of;
  position[3 * at] = x;
  position[3 * at + 1] = y;
  position[3 * at + 2] = z;
  onMap[4 * at] = longitude + aboutZero(lon - longitude);
  onMap[4 * at + 1] = cosine;
  onMap[4 * at + 2] = sine;
  onMap[4 * at + 3] = longitude;
  return at;
}

/**
 * Corners of the fans of all polygons: `position` (3 each) on the sphere; `onMap` (4 each) longitude, cosine and sine
 * of Mollweide's angle, and the longitude of the polygon; `part` and `index` as in `Fans`. `centres` (3 for each
 * polygon) lie within.
 */
export function sphereFans(points, { starts, rings, count }) {
  const fans = new Fans(starts[count] + 2 * count, { position: 3, onMap: 4 });
  const corners = (points.corners ??= cornersOf(points)); // the same for cells and triangles
  const centres = new Float64Array(3 * count);
  for (let number = 0; number < count; number++) {
    const ring = outline(points, corners, rings, starts[number], starts[number + 1]);
    const centre = middle(ring);
    for (let axis = 0; axis < 3; axis++) centres[3 * number + axis] = centre[axis];
    addFan(fans, number, ring, centre);
  }
  return { ...fans.filled, centres };
}

function addFan(fans, number, ring, centre) {
  const pole = Math.sign(centre[2]);
  const polar = Math.abs(centre[2]) > 0.7 && holdsPole(ring, pole);
  if (!polar && ring.every((each) => Math.abs(aboutZero(each[3] - centre[3])) < WIDE)) {
    const hub = addCorner(fans, centre, number, 1, centre[3]);
    for (const each of ring) addCorner(fans, each, number, 0, centre[3]);
    fans.round(hub, ring.length);
    return;
  }
  const hub = polar ? [0, 0, pole, 0, (pole * Math.PI) / 2, 0, pole] : centre;
  ring.forEach((each, k) => addSector(fans, number, hub, each, ring[(k + 1) % ring.length], polar));
}

/** A triangle of a wide polygon, in strips: the map bends its sides, most of all those that end at a pole. */
function addSector(fans, number, hub, first, last, polar) {
  const longitude = first[3] + aboutZero(last[3] - first[3]) / 2;
  const tip = polar ? [...hub.slice(0, 3), longitude, ...hub.slice(4)] : hub;
  let before = null;
  for (let strip = 1; strip <= STRIPS; strip++) {
    const share = polar ? (strip / STRIPS) ** 2 : strip / STRIPS;
    const ends = [first, last].map((end) => addCorner(fans, between(hub, end, share), number, 1 - share, longitude));
    if (before === null) {
      fans.triangle(addCorner(fans, tip, number, 1, longitude), ...ends);
    } else {
      fans.triangle(before[0], ends[0], ends[1]);
      fans.triangle(before[0], ends[1], before[1]);
    }
    before = ends;
  }
}
