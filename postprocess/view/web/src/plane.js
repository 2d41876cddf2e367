// What is the plane's own: its points, its view from above, and the way from places {x, y} to polygons. Lengths are in
// units of the longer side of the plane, from its lower left corner. Where the plane repeats itself, one period is shown
// round the camera: each polygon at its image nearest to it, and those on the rim once more on the other side.

import { Vector2 } from "three";
import { Fans } from "./fans.js";
import { inDigits } from "./numbers.js";
import { goesRound } from "./picking.js";
import { clamp } from "./projections.js";
import { unpacked } from "./unpack.js";

const METRES_OF_A_KILOMETRE = 1000;
const IN_KILOMETRES = 10000; // metres: places on longer planes are told in kilometres
const STEPS = 2000; // along the plane that places are told apart by

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
    this.kinds = { plane: { defines: { PLANE: 1 }, attribute: "place", size: 4, onLine: (place, of) => this.besides(place, of), copies } };
    this.uniforms = {
      centre: { value: new Vector2() },
      periods: { value: new Vector2(...this.periods) },
      reach: { value: 0 },
    };
  }

  get view() {
    const rim = this.periods.map((period) => (period > 0 ? 2 * this.mesh.spacing : 0));
    return {
      width: this.extent[0] + rim[0],
      height: this.extent[1] + rim[1],
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

  aim(camera) {
    this.uniforms.centre.value.set(camera.x, camera.y);
    this.uniforms.reach.value = this.reach;
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

  /**
   * Corners of the fans of all polygons: `place` (4 each) the corner and the middle of its polygon, which lies where the
   * plane begins; `part` and `index` as in `Fans`. `centres` (3 for each polygon) are these middles, `reach` is the
   * largest distance along x or y from them.
   */
  fans({ starts, rings, count }) {
    const fans = new Fans(starts[count] + count, { place: 4 });
    const centres = new Float64Array(3 * count);
    let reach = 0;
    for (let number = 0; number < count; number++) {
      const ring = this.outline(rings, starts[number], starts[number + 1]);
      const middle = [0, 1].map((axis) => ring.reduce((sum, corner) => sum + corner[axis], 0) / ring.length);
      const home = middle.map((value, axis) => this.wrapped(axis, value));
      centres.set(home, 3 * number);
      const add = (corner, within) => fans.of.place.set([...corner, ...home], 4 * fans.corner(number, within));
      const hub = fans.corners;
      add(home, 1);
      for (const corner of ring) {
        const way = corner.map((value, axis) => value - middle[axis]);
        reach = Math.max(reach, Math.abs(way[0]), Math.abs(way[1]));
        add([home[0] + way[0], home[1] + way[1]], 0);
      }
      fans.round(hub, ring.length);
    }
    this.reach = Math.max(this.reach, reach);
    return { ...fans.filled, centres };
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
    const { x, y } = this.points;
    return goesRound(starts[number], starts[number + 1], (k) => [
      centre[0] - point[0] + this.shortest(0, x[rings[k]] - centre[0]),
      centre[1] - point[1] + this.shortest(1, y[rings[k]] - centre[1]),
    ]);
  }

  /** Whether a polygon with this middle, which holds the image `point` of a place, is drawn there. */
  draws(centre, point, place, camera) {
    return ["x", "y"].every((name, axis) => {
      const from = centre[axis] - point[axis] + place[name] - camera[name];
      return !(this.periods[axis] > 0) || Math.abs(from) <= this.periods[axis] / 2 + this.reach;
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

  /** A place on a line that begins at the place `of`: its nearest image, and where the line begins. */
  besides(place, of) {
    return [of.x + this.shortest(0, place.x - of.x), of.y + this.shortest(1, place.y - of.y), of.x, of.y];
  }

  graticule() {
    return [];
  }
}
