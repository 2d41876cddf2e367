// Rings of points of the mesh, from what postprocess/view/outlines.py packed.

import { unpacked } from "./unpack.js";

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
