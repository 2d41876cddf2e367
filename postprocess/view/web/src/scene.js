// The picture: one camera for all panes, each of which shows its own values.

import { Camera, DataTexture, NearestFilter, RedIntegerFormat, RGBAFormat, Scene, UnsignedByteType, UnsignedShortType, Vector2, Vector3, Vector4, WebGLRenderer } from "three";
import { ground, lines, patches } from "./layers.js";

const ACROSS = 2048; // values in a row of a texture
const MARGIN = 0.94;

/** Boxes of equal panes, in columns and rows such that the view is as large as can be. */
function arranged(count, size, view) {
  const choices = [1, 2, 3].filter((columns) => columns <= count).map((columns) => {
    const [width, height] = [size.width / columns, size.height / Math.ceil(count / columns)];
    return { columns, width, height, fit: Math.min(width / view.width, height / view.height) };
  });
  const { columns, width, height } = choices.reduce((best, each) => (each.fit > best.fit ? each : best));
  const boxes = Array.from({ length: count }, (_, i) => ({ x: (i % columns) * width, y: Math.floor(i / columns) * height }));
  return { width, height, boxes };
}

export class Picture {
  constructor(canvas, surface) {
    this.surface = surface;
    this.renderer = new WebGLRenderer({ canvas, antialias: true, alpha: true });
    this.renderer.autoClear = false;
    this.scene = new Scene();
    this.eye = new Camera();
    this.layers = [];
    this.uniforms = {
      scale: { value: new Vector2() },
      shift: { value: new Vector2() },
      half_: { value: new Vector2() },
      pixels: { value: new Vector2() },
      land: { value: new Vector3() },
      palette: { value: null },
      values: { value: null },
      across: { value: ACROSS },
      missing: { value: 255 },
      toTone: { value: new Vector2() },
      pointed: { value: -1 },
      density: { value: 1 },
      ...surface.uniforms,
    };
    const ink = (r, g, b, a, width) => ({ ...this.uniforms, ink: { value: new Vector4(r, g, b, a) }, width: { value: width } });
    this.coastInk = ink(0.05, 0.05, 0.05, 1, 1.6);
    this.lineInk = ink(0, 0, 0, 0.16, 1);
  }

  /** Draw what lies behind the cells and over them, the ground and lines, where the surface has such. */
  addFrame() {
    const pairs = this.surface.graticule();
    if (!pairs.length) return;
    this.scene.add(ground(this.uniforms));
    this.addLines(pairs, 2, this.lineInk);
  }

  add(layer) {
    this.layers.push(layer);
    this.scene.add(...Object.values(layer.views).flat());
    return layer;
  }

  /** Draw lines between pairs of places. */
  addLines(pairs, order, ink) {
    if (pairs.length) this.add({ views: lines(pairs, order, this.surface.kinds, ink) });
  }

  addPatches(fans) {
    return this.add({ views: patches(fans, this.surface.kinds, this.uniforms), fans, ofPlace: true });
  }

  /** A texture of the colours (three bytes each) of a palette. */
  palette(colours) {
    const texels = new Uint8Array((colours.length / 3) * 4).fill(255);
    for (let i = 0; i < colours.length / 3; i++) texels.set(colours.subarray(3 * i, 3 * i + 3), 4 * i);
    const made = new DataTexture(texels, texels.length / 4, 1, RGBAFormat, UnsignedByteType);
    made.needsUpdate = true;
    return made;
  }

  /** A texture for `count` values of `bits`, to be filled by `fill`. */
  texture(count, bits) {
    const rows = Math.ceil(count / ACROSS);
    const Kind = bits === 8 ? Uint8Array : Uint16Array;
    const type = bits === 8 ? UnsignedByteType : UnsignedShortType;
    const made = new DataTexture(new Kind(rows * ACROSS), ACROSS, rows, RedIntegerFormat, type);
    made.internalFormat = bits === 8 ? "R8UI" : "R16UI";
    made.minFilter = made.magFilter = NearestFilter;
    made.unpackAlignment = bits / 8;
    return made;
  }

  fill(texture, values) {
    texture.image.data.set(values);
    texture.needsUpdate = true;
  }

  /** Width and height of the canvas in CSS pixels, as it is now. */
  size() {
    const { clientWidth, clientHeight } = this.renderer.domElement;
    return { width: Math.max(1, clientWidth), height: Math.max(1, clientHeight) };
  }

  /** How panes lie: their boxes, pixels for a unit of length of the surface, and the middle of each pane on the view. */
  framing(state) {
    const view = this.surface.views[state.projection];
    const { width, height, boxes } = arranged(state.panes, this.size(), view);
    const scale = MARGIN * Math.min(width / view.width, height / view.height) * state.camera.zoom;
    return { width, height, boxes, scale, middle: view.middle(state.camera, height / 2 / scale, width / 2 / scale) };
  }

  /** Draw all panes; `panes` have `texture`, `missing`, `palette`, `scale` and `offset` to tones. */
  draw(state, panes, shownLayer) {
    const { renderer, uniforms } = this;
    const density = window.devicePixelRatio || 1;
    const size = this.size();
    if (renderer.getPixelRatio() !== density) renderer.setPixelRatio(density);
    const now = renderer.getSize(new Vector2());
    if (now.x !== size.width || now.y !== size.height) renderer.setSize(size.width, size.height, false);
    const { width, height, boxes, scale, middle } = this.framing(state);
    uniforms.scale.value.set((2 * scale) / width, (2 * scale) / height);
    uniforms.shift.value.set(-middle[0] * uniforms.scale.value.x, -middle[1] * uniforms.scale.value.y);
    const { width: across, height: high } = this.surface.views[state.projection];
    uniforms.half_.value.set(across / 2, high / 2);
    this.surface.aim(state.camera, shownLayer);
    uniforms.pixels.value.set((width * density) / 2, (height * density) / 2);
    uniforms.density.value = density;
    uniforms.pointed.value = state.pointed;
    this.coastInk.width.value = 1.6 * density;
    this.lineInk.width.value = density;
    for (const layer of this.layers)
      for (const [view, meshes] of Object.entries(layer.views))
        for (const mesh of meshes) mesh.visible = view === state.projection && (!layer.ofPlace || layer === shownLayer);
    renderer.setScissorTest(true);
    panes.forEach((pane, i) => {
      uniforms.values.value = pane.texture;
      uniforms.missing.value = pane.missing;
      uniforms.toTone.value.set(pane.scale, pane.offset);
      uniforms.palette.value = pane.palette;
      const up = size.height - boxes[i].y - height;
      renderer.setViewport(boxes[i].x, up, width, height);
      renderer.setScissor(boxes[i].x, up, width, height);
      renderer.clear();
      renderer.render(this.scene, this.eye);
    });
  }
}
