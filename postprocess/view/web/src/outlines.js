// Points and rings of the mesh, from what postprocess/view/outlines.py packed.

import { TURN } from "./projections.js";
import { unpacked } from "./unpack.js";

/** Longitudes, latitudes (radians) and unit vectors of all points. */
export async function pointsOf(mesh) {
  const [eastward, northward] = await Promise.all([
    unpacked(mesh.longitude, 1, mesh.points, mesh.angleBits),
    unpacked(mesh.latitude, 1, mesh.points, mesh.angleBits),
  ]);
  const top = 2 ** mesh.angleBits - 1;
  const points = { lon: new Float64Array(mesh.points), lat: new Float64Array(mesh.points), xyz: new Float64Array(3 * mesh.points) };
  for (let i = 0; i < mesh.points; i++) {
    const lon = (eastward[i] / top) * TURN;
    const lat = (northward[i] / top - 0.5) * Math.PI;
    const ring = Math.cos(lat);
    points.lon[i] = lon;
    points.lat[i] = lat;
    points.xyz[3 * i] = ring * Math.cos(lon);
    points.xyz[3 * i + 1] = ring * Math.sin(lon);
    points.xyz[3 * i + 2] = Math.sin(lat);
  }
  return points;
}

/** Where each ring starts (count + 1), and the numbers of the points of all rings. */
export async function ringsOf(place, bits) {
  const [counts, rings] = await Promise.all([
    unpacked(place.counts, 1, place.count, 8),
    unpacked(place.rings, 1, place.corners, bits),
  ]);
  const starts = new Uint32Array(place.count + 1);
  for (let i = 0; i < place.count; i++) starts[i + 1] = starts[i] + counts[i];
  return { starts, rings, count: place.count };
}

/** Both ends of each piece of the coast, numbers of points. */
export const coastOf = (mesh) => unpacked(mesh.coast.ends, 1, mesh.coast.count, mesh.numberBits);
