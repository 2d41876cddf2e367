// What is drawn: the ground, the polygons of cells, triangles or edges, the coast, meridians and parallels.

import { BufferAttribute, BufferGeometry, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, RawShaderMaterial } from "three";
import { aboutZero, mollweideAngle, placeOf, pointOf } from "./projections.js";
import { GROUND_CORNERS, GROUND_PIXELS, LINE_CORNERS, LINE_PIXELS, PATCH_CORNERS, PATCH_PIXELS } from "./shaders.js";

function drawn(geometry, order, vertexShader, fragmentShader, uniforms, { map = false, transparent = false } = {}) {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms,
    transparent,
    defines: map ? { MAP: 1 } : {},
    depthTest: false,
    depthWrite: false,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  return mesh;
}

/** Draws one more time what the rim of the map cuts. */
function withCopy(uniforms, make) {
  return [make({ ...uniforms, copy: { value: 0 } }), make({ ...uniforms, copy: { value: 1 } })];
}

export function ground(uniforms) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("corner", new BufferAttribute(new Float32Array([-1.01, -1.01, 1.01, -1.01, 1.01, 1.01, -1.01, 1.01]), 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  return drawn(geometry, 0, GROUND_CORNERS, GROUND_PIXELS, uniforms, { transparent: true });
}

/** Polygons on the globe, and on the map, that share what they have in common. */
export function patches(fans, uniforms) {
  const index = new BufferAttribute(fans.index, 1);
  const part = new BufferAttribute(fans.part, 2);
  const geometry = (name, size) => {
    const made = new BufferGeometry();
    made.setAttribute(name, new BufferAttribute(fans[name], size));
    made.setAttribute("part", part);
    made.setIndex(index);
    return made;
  };
  const flat = geometry("onMap", 4);
  const overGround = { transparent: true }; // opaque things would be drawn before the ground
  return {
    globe: [drawn(geometry("position", 3), 1, PATCH_CORNERS, PATCH_PIXELS, { ...uniforms }, overGround)],
    map: withCopy(uniforms, (all) => drawn(flat, 1, PATCH_CORNERS, PATCH_PIXELS, all, { ...overGround, map: true })),
  };
}

/** Pieces of lines between pairs of places, each [{lon, lat}, {lon, lat}]. */
export function lines(pairs, order, uniforms) {
  const geometry = (size, corners) => {
    const made = new InstancedBufferGeometry();
    made.setAttribute("corner", new BufferAttribute(new Float32Array([0, -0.5, 1, -0.5, 1, 0.5, 0, 0.5]), 2));
    made.setIndex([0, 1, 2, 0, 2, 3]);
    ["start", "end"].forEach((name, which) => {
      const values = new Float32Array(size * pairs.length);
      pairs.forEach((pair, i) => values.set(corners(pair[which], pair), size * i));
      made.setAttribute(name, new InstancedBufferAttribute(values, size));
    });
    made.instanceCount = pairs.length;
    return made;
  };
  const onMap = ({ lon, lat }, [first]) => {
    const angle = mollweideAngle(lat);
    return [first.lon + aboutZero(lon - first.lon), Math.cos(angle), Math.sin(angle), first.lon];
  };
  const flat = geometry(4, onMap);
  const round = geometry(3, ({ lon, lat }) => pointOf(lon, lat));
  return {
    globe: [drawn(round, order, LINE_CORNERS, LINE_PIXELS, { ...uniforms }, { transparent: true })],
    map: withCopy(uniforms, (all) => drawn(flat, order, LINE_CORNERS, LINE_PIXELS, all, { map: true, transparent: true })),
  };
}

/** Pieces of the coast, cut where they are long, as sides of cells are. */
export function coastPieces(points, ends) {
  const pairs = [];
  for (let k = 0; k < ends.length; k += 2) {
    const [a, b] = [ends[k], ends[k + 1]].map((point) => points.xyz.subarray(3 * point, 3 * point + 3));
    const count = Math.max(1, Math.ceil(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / 0.06));
    const at = (share) => placeOf([0, 1, 2].map((axis) => (1 - share) * a[axis] + share * b[axis]));
    for (let i = 0; i < count; i++) pairs.push([at(i / count), at((i + 1) / count)]);
  }
  return pairs;
}

/** Meridians and parallels every 30 degrees, in pieces of three. */
export function graticule() {
  const degree = Math.PI / 180;
  const pairs = [];
  for (let lon = 0; lon < 360; lon += 30)
    for (let lat = -90; lat < 90; lat += 3) pairs.push([lat, lat + 3].map((each) => ({ lon: lon * degree, lat: each * degree })));
  for (let lat = -60; lat <= 60; lat += 30)
    for (let lon = 0; lon < 360; lon += 3) pairs.push([lon, lon + 3].map((each) => ({ lon: each * degree, lat: lat * degree })));
  return pairs;
}
