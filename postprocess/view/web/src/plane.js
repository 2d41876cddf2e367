// What is the plane's own: its points, its view from above, and the way from places {x, y} to polygons. Lengths are in
// units of the longer side of the plane, from its lower left corner. Where the plane repeats itself, one period is shown
// round the camera: each polygon at its image nearest to it, and those that the border cuts once more on the other side.

import { BufferAttribute, Vector2 } from "three";
import { Fans } from "./fans.js";
import { inDigits } from "./numbers.js";
import { goesRound } from "./picking.js";
import { clamp } from "./projections.js";
import { unpacked } from "./unpack.js";

const METRES_OF_A_KILOMETRE = 1000;
const IN_KILOMETRES = 10000; // metres: places on longer planes are told in kilometres
const STEPS = 2000; // along the plane that places are told apart by

const CUT = 0.999; // of a polygon's reach: one that the border only touches is not cut; shaders have the same for lines

export class Plane {
  constructor(mesh) {
    this.mesh = mesh;
    const { extent, periods } = mesh.plane;
    this.unit = Math.max(...extent);
    this.extent = extent.map((length) => length / this.unit);
    this.periods = periods.map((length) => length / this.unit);
    this.outside = "no cell";
    this.low = [0, 0, 0];
    this.size = 1;
    this.reach = 0; // from the middle of a polygon to its rim, at most
    this.views = { plane: this.view };
    const both = periods.map((period) => (period > 0 ? [0, 1] : [0]));
    const copies = both[0].flatMap((x) => both[1].map((y) => ({ copy: { value: new Vector2(x, y) } })));
    this.kinds = { plane: { defines: { PLANE: 1 }, attributes: { place: 4 }, size: 4, onLine: (place, pair) => this.onLine(place, pair), copies } };
    this.uniforms = {
      centre: { value: new Vector2() },
      periods: { value: new Vector2(...this.periods) },
    };
  }

  /** A side of the plane with the polygons that its border cuts. */
  across(axis) {
    return this.extent[axis] + (this.periods[axis] > 0 ? 2 * this.reach : 0);
  }

  get view() {
    const plane = this;
    return {
      get width() {
        return plane.across(0);
      },
      get height() {
        return plane.across(1);
      },
      /** From the camera to the middle of the picture, no further than where the plane fills it. */
      middle: (camera, high, wide) => [this.kept(0, camera.x, wide) - camera.x, this.kept(1, camera.y, high) - camera.y],
      /** The place seen `x` to the right of the camera and `y` above it, or null beyond the rim. */
      place: (x, y, camera) => {
        const place = { x: camera.x + x, y: camera.y + y };
        const seen = [x, y].every((way, axis) => {
          if (this.periods[axis] > 0) return Math.abs(way) <= this.periods[axis] / 2 + this.reach;
          return Math.abs([place.x, place.y][axis] - this.extent[axis] / 2) <= this.extent[axis] / 2;
        });
        return seen ? place : null;
      },
    };
  }

  /** A coordinate of the camera where a picture, `half` as wide from there, shows the plane as far as it can. */
  kept(axis, value, half) {
    if (this.periods[axis] > 0) return value;
    const middle = this.extent[axis] / 2;
    const furthest = Math.max(0, middle - half);
    return clamp(value, middle - furthest, middle + furthest);
  }

  /** Unpack x and y of all points. */
  async load() {
    const { mesh } = this;
    const { begin, low, span } = mesh.plane;
    const top = 2 ** mesh.lengthBits - 1;
    const along = async (text, axis) => {
      const steps = await unpacked(text, 1, mesh.points, mesh.lengthBits);
      return Float64Array.from(steps, (step) => (low[axis] - begin[axis] + (step / top) * span) / this.unit);
    };
    const [x, y] = await Promise.all([along(mesh.x, 0), along(mesh.y, 1)]);
    this.points = { x, y };
  }

  get start() {
    return { x: this.extent[0] / 2, y: this.extent[1] / 2, zoom: 1 };
  }

  /** The shorter way between images of places that are as far apart along an axis. */
  shortest(axis, way) {
    const period = this.periods[axis];
    return period > 0 ? way - period * Math.round(way / period) : way;
  }

  /** The image of a coordinate from zero up to the period. */
  wrapped(axis, value) {
    const period = this.periods[axis];
    return period > 0 ? value - period * Math.floor(value / period) : value;
  }

  /** Move the camera by as many pixels, in a view where these are framed as `Picture.framing` tells. */
  turn(camera, dx, dy, { scale, middle }) {
    this.moveTo(camera, camera.x + middle[0] - dx / scale, camera.y + middle[1] + dy / scale);
  }

  /** Move the camera so that the place `before` comes to where `after` is seen. */
  hold(camera, before, after, { middle }) {
    this.moveTo(camera, camera.x + middle[0] + before.x - after.x, camera.y + middle[1] + before.y - after.y);
  }

  moveTo(camera, x, y) {
    const within = (axis, value) => (this.periods[axis] > 0 ? this.wrapped(axis, value) : clamp(value, 0, this.extent[axis]));
    Object.assign(camera, { x: within(0, x), y: within(1, y) });
  }

  /** Tell shaders where the camera is, and copies of the polygons of a layer which of them to draw. */
  aim(camera, layer) {
    this.uniforms.centre.value.set(camera.x, camera.y);
    if (layer.seenFrom?.x === camera.x && layer.seenFrom?.y === camera.y) return;
    layer.seenFrom = { x: camera.x, y: camera.y };
    for (const mesh of layer.views.plane) {
      const repeated = [0, 1].filter((axis) => mesh.material.uniforms.copy.value.getComponent(axis) > 0);
      if (repeated.length) mesh.geometry.setIndex(new BufferAttribute(this.cut(layer.fans, camera, repeated), 1));
    }
  }

  /** Corners of the triangles of all polygons that the border cuts along these axes. */
  cut({ index, centres, rims, starts }, camera, axes) {
    const at = [camera.x, camera.y];
    const found = [];
    for (let number = 0; number < starts.length - 1; number++) {
      const isCut = axes.every((axis) => {
        const from = Math.abs(this.shortest(axis, centres[3 * number + axis] - at[axis]));
        return from > this.periods[axis] / 2 - CUT * rims[2 * number + axis];
      });
      if (isCut) for (let k = 3 * starts[number]; k < 3 * starts[number + 1]; k++) found.push(index[k]);
    }
    return Uint32Array.from(found);
  }

  /** Corners of a ring one after another [x, y], each at its image nearest to the one before. */
  outline(rings, start, end) {
    const { x, y } = this.points;
    const found = [[x[rings[start]], y[rings[start]]]];
    for (let k = start + 1; k < end; k++) {
      const [atX, atY] = found[found.length - 1];
      found.push([atX + this.shortest(0, x[rings[k]] - atX), atY + this.shortest(1, y[rings[k]] - atY)]);
    }
    return found;
  }

  middleOf(corners) {
    return [0, 1].map((axis) => corners.reduce((sum, corner) => sum + corner[axis], 0) / corners.length);
  }

  /** How far a polygon reaches along x and y from a point within. */
  reachOf(corners, [x, y]) {
    return [Math.max(...corners.map((corner) => Math.abs(corner[0] - x))), Math.max(...corners.map((corner) => Math.abs(corner[1] - y)))];
  }

  /**
   * Corners of the fans of all polygons: `place` (4 each) the corner and the middle of its polygon, which lies where the
   * plane begins; `part` and `index` as in `Fans`. `centres` (3 for each polygon) are the middles, `rims` (2 each) how
   * far polygons reach from there, and `starts` the numbers of their first triangles.
   */
  fans({ starts, rings, count }) {
    const fans = new Fans(starts[count] + count, this.kinds.plane.attributes);
    const [centres, rims] = [new Float64Array(3 * count), new Float64Array(2 * count)];
    for (let number = 0; number < count; number++) {
      const ring = this.outline(rings, starts[number], starts[number + 1]);
      const middle = this.middleOf(ring);
      const home = middle.map((value, axis) => this.wrapped(axis, value));
      const rim = this.reachOf(ring, middle);
      this.reach = Math.max(this.reach, ...rim);
      centres.set(home, 3 * number);
      rims.set(rim, 2 * number);
      const add = (x, y, within) => {
        const at = fans.corner(number, within);
        fans.of.place.set([x, y, ...home], 4 * at);
        return at;
      };
      const hub = add(...home, 1);
      for (const [x, y] of ring) add(home[0] + x - middle[0], home[1] + y - middle[1], 0);
      fans.round(hub, ring.length);
    }
    return { ...fans.filled, centres, rims, starts };
  }

  /** Points for `holds` that may be in the polygon which is seen at a place: its images near where the plane begins. */
  images({ x, y }) {
    const along = [x, y].map((value, axis) => {
      const [period, home] = [this.periods[axis], this.wrapped(axis, value)];
      if (!(period > 0)) return [home];
      return [home, home - period, home + period].filter((each) => each >= -this.reach && each <= period + this.reach);
    });
    return along[0].flatMap((atX) => along[1].map((atY) => [atX, atY, 0]));
  }

  /** Whether the sides of a polygon go round a point. */
  holds({ starts, rings }, number, centre, point) {
    const corners = this.outline(rings, starts[number], starts[number + 1]);
    const back = [0, 1].map((axis) => point[axis] - centre[axis] + this.middleOf(corners)[axis]);
    return goesRound(0, corners.length, (k) => [corners[k][0] - back[0], corners[k][1] - back[1]]);
  }

  /** Whether a polygon with this middle, which holds the image `point` of a place, is drawn there. */
  draws({ starts, rings }, number, centre, point, place, camera) {
    const corners = this.outline(rings, starts[number], starts[number + 1]);
    const rim = this.reachOf(corners, this.middleOf(corners));
    return ["x", "y"].every((name, axis) => {
      const from = centre[axis] - point[axis] + place[name] - camera[name];
      return !(this.periods[axis] > 0) || Math.abs(from) <= this.periods[axis] / 2 + CUT * rim[axis];
    });
  }

  /** The image of a place where the plane begins. */
  home({ x, y }) {
    return { x: this.wrapped(0, x), y: this.wrapped(1, y) };
  }

  /** Coordinates of a place in metres, as files have them. */
  inMetres({ x, y }) {
    const { begin } = this.mesh.plane;
    return [begin[0] + x * this.unit, begin[1] + y * this.unit];
  }

  inWords(place) {
    const [divisor, unit] = this.unit >= IN_KILOMETRES ? [METRES_OF_A_KILOMETRE, "km"] : [1, "m"];
    const [x, y] = this.inMetres(place).map((value) => inDigits(value / divisor, this.unit / divisor / STEPS, 0));
    return `x ${x} ${unit}, y ${y} ${unit}`;
  }

  /** The walls between the points `ends`, two each, as pairs of places. */
  coast(ends) {
    const { x, y } = this.points;
    const pairs = [];
    for (let k = 0; k < ends.length; k += 2) pairs.push([ends[k], ends[k + 1]].map((point) => ({ x: x[point], y: y[point] })));
    return pairs;
  }

  /** An end of a line between a pair of places and the middle of that line, at images next to each other. */
  onLine({ x, y }, [first, last]) {
    const middle = [first.x + this.shortest(0, last.x - first.x) / 2, first.y + this.shortest(1, last.y - first.y) / 2];
    return [middle[0] + this.shortest(0, x - middle[0]), middle[1] + this.shortest(1, y - middle[1]), ...middle];
  }

  graticule() {
    return [];
  }
}
