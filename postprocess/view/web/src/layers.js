// What is drawn: the ground, the polygons of cells, triangles or edges, and lines, in each view of the surface.

import { BufferAttribute, BufferGeometry, GLSL3, InstancedBufferAttribute, InstancedBufferGeometry, Mesh, RawShaderMaterial } from "three";
import { GROUND_CORNERS, GROUND_PIXELS, LINE_CORNERS, LINE_PIXELS, PATCH_CORNERS, PATCH_PIXELS } from "./shaders.js";

function drawn(geometry, order, vertexShader, fragmentShader, uniforms, defines = {}) {
  const material = new RawShaderMaterial({
    glslVersion: GLSL3,
    vertexShader,
    fragmentShader,
    uniforms,
    transparent: true, // all of it: opaque things would be drawn before the ground
    defines,
    depthTest: false,
    depthWrite: false,
  });
  const mesh = new Mesh(geometry, material);
  mesh.frustumCulled = false;
  mesh.renderOrder = order;
  return mesh;
}

/** For each view by name, all images that are drawn in it; `geometryOf` a kind of view makes that of each image. */
function inEachView(kinds, order, programs, uniforms, geometryOf) {
  const views = Object.entries(kinds).map(([name, kind]) => {
    const geometry = geometryOf(kind);
    return [name, kind.copies.map((own) => drawn(geometry(), order, ...programs, { ...uniforms, ...own }, kind.defines))];
  });
  return Object.fromEntries(views);
}

export function ground(uniforms) {
  const geometry = new BufferGeometry();
  geometry.setAttribute("corner", new BufferAttribute(new Float32Array([-1.01, -1.01, 1.01, -1.01, 1.01, 1.01, -1.01, 1.01]), 2));
  geometry.setIndex([0, 1, 2, 0, 2, 3]);
  return drawn(geometry, 0, GROUND_CORNERS, GROUND_PIXELS, uniforms);
}

/** Polygons, which share in all views what they have in common. */
export function patches(fans, kinds, uniforms) {
  const index = new BufferAttribute(fans.index, 1);
  const part = new BufferAttribute(fans.part, 2);
  return inEachView(kinds, 1, [PATCH_CORNERS, PATCH_PIXELS], uniforms, ({ attributes }) => {
    const made = Object.entries(attributes).map(([name, size]) => [name, new BufferAttribute(fans[name], size)]);
    return () => {
      const geometry = new BufferGeometry();
      for (const [name, attribute] of [...made, ["part", part]]) geometry.setAttribute(name, attribute);
      return geometry.setIndex(index);
    };
  });
}

/** Pieces of lines between pairs of places. */
export function lines(pairs, order, kinds, uniforms) {
  return inEachView(kinds, order, [LINE_CORNERS, LINE_PIXELS], uniforms, ({ size, onLine }) => {
    const made = new InstancedBufferGeometry();
    made.setAttribute("corner", new BufferAttribute(new Float32Array([0, -0.5, 1, -0.5, 1, 0.5, 0, 0.5]), 2));
    made.setIndex([0, 1, 2, 0, 2, 3]);
    ["start", "end"].forEach((name, which) => {
      const values = new Float32Array(size * pairs.length);
      pairs.forEach((pair, i) => values.set(onLine(pair[which], pair), size * i));
      made.setAttribute(name, new InstancedBufferAttribute(values, size));
    });
    made.instanceCount = pairs.length;
    return () => made;
  });
}
