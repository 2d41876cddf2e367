// What is the sphere's own: its points, its two views, and the way from places {lon, lat}, radians, to polygons.

import { Matrix3 } from "three";
import { inDegrees } from "./numbers.js";
import { goesRound } from "./picking.js";
import { aboutZero, axesOf, clamp, mollweideAngle, placeOf, pointOf, PROJECTIONS, TURN } from "./projections.js";
import { sphereFans } from "./sphere_fans.js";
import { unpacked } from "./unpack.js";

const START = { lon: -Math.PI / 2, lat: Math.PI / 9, zoom: 1 };
const PIECE_OF_COAST = 0.06;

/** Places on the map: longitude, cosine and sine of Mollweide's angle, longitude of where their line begins. */
function onMap({ lon, lat }, [of]) {
  const angle = mollweideAngle(lat);
  return [of.lon + aboutZero(lon - of.lon), Math.cos(angle), Math.sin(angle), of.lon];
}

/**
 * How each view is drawn: the attributes of fans that it reads, the ends of lines between pairs of places and their
 * `size`, and the images that are drawn of everything.
 */
const KINDS = {
  globe: { defines: {}, attributes: { position: 3 }, size: 3, onLine: ({ lon, lat }) => pointOf(lon, lat), copies: [{}] },
  // Once more what the rim of the map cuts.
  map: { defines: { MAP: 1 }, attributes: { onMap: 4 }, size: 4, onLine: onMap, copies: [{ copy: { value: 0 } }, { copy: { value: 1 } }] },
};

export class Sphere {
  constructor(mesh) {
    this.mesh = mesh;
    this.views = PROJECTIONS;
    this.kinds = KINDS;
    this.uniforms = { view: { value: new Matrix3() }, middle: { value: 0 } };
    this.outside = "land";
    this.low = [-1, -1, -1]; // of all points
    this.size = 2;
  }

  /** Unpack longitudes, latitudes (radians) and unit vectors of all points. */
  async load() {
    const { mesh } = this;
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
    this.points = points;
  }

  /** The camera of the first view: that of all cells, where these do not cover the globe. */
  get start() {
    if (this.mesh.closed) return { ...START };
    const [{ xyz }, [first, count]] = [this.points, this.mesh.cellPoints];
    const sum = [0, 0, 0];
    for (let i = 3 * first; i < 3 * (first + count); i++) sum[i % 3] += xyz[i];
    const length = Math.hypot(...sum) || 1;
    let nearest = 1;
    for (let i = first; i < first + count; i++) {
      const along = (xyz[3 * i] * sum[0] + xyz[3 * i + 1] * sum[1] + xyz[3 * i + 2] * sum[2]) / length;
      nearest = Math.min(nearest, along);
    }
    const reach = nearest > 0 ? Math.sqrt(1 - nearest * nearest) : 1;
    return { ...placeOf(sum), zoom: Math.max(1, 0.8 / Math.max(reach, 1e-6)) };
  }

  /** Turn the camera by as many pixels, in a view where these are framed as `Picture.framing` tells. */
  turn(camera, dx, dy, { scale }, view) {
    const shrunk = Math.max(0.2, Math.cos(camera.lat));
    camera.lon = aboutZero(camera.lon - dx / scale / (view === "globe" ? shrunk : 0.9));
    camera.lat = clamp(camera.lat + dy / scale, -Math.PI / 2, Math.PI / 2);
  }

  /** Turn the camera so that the place `before` comes to where `after` is seen. */
  hold(camera, before, after) {
    camera.lon = aboutZero(camera.lon + aboutZero(before.lon - after.lon));
    camera.lat = clamp(camera.lat + before.lat - after.lat, -Math.PI / 2, Math.PI / 2);
  }

  aim(camera) {
    this.uniforms.view.value.set(...axesOf(camera).flat());
    this.uniforms.middle.value = camera.lon;
  }

  fans(rings) {
    return sphereFans(this.points, rings);
  }

  /** Points for `holds` that may be in the polygon which is seen at a place. */
  images({ lon, lat }) {
    return [pointOf(lon, lat)];
  }

  /** Whether the sides of a polygon, seen from the middle of the sphere, go round a point. */
  holds({ starts, rings }, number, centre, [x, y, z]) {
    const { xyz } = this.points;
    if (Math.hypot(centre[0] - x, centre[1] - y, centre[2] - z) > 1) return false;
    // Any two directions across the point's own.
    const across = Math.abs(z) < 0.9 ? [-y, x, 0] : [0, -z, y];
    const other = [y * across[2] - z * across[1], z * across[0] - x * across[2], x * across[1] - y * across[0]];
    return goesRound(starts[number], starts[number + 1], (k) => {
      const [px, py, pz] = xyz.subarray(3 * rings[k], 3 * rings[k] + 3);
      const depth = px * x + py * y + pz * z;
      return [(px * across[0] + py * across[1] + pz * across[2]) / depth, (px * other[0] + py * other[1] + pz * other[2]) / depth];
    });
  }

  /** Whether a polygon that holds an image of a place is drawn there. */
  draws() {
    return true;
  }

  /** The place of its polygon that is seen at a place. */
  home(place) {
    return place;
  }

  inWords({ lon, lat }) {
    const east = aboutZero(lon);
    return `${inDegrees(lat)}° ${lat < 0 ? "S" : "N"}, ${inDegrees(east)}° ${east < 0 ? "W" : "E"}`;
  }

  /** Pieces of the coast between the points `ends`, two each, cut where they are long, as sides of cells are. */
  coast(ends) {
    const { xyz } = this.points;
    const pairs = [];
    for (let k = 0; k < ends.length; k += 2) {
      const [a, b] = [ends[k], ends[k + 1]].map((point) => xyz.subarray(3 * point, 3 * point + 3));
      const count = Math.max(1, Math.ceil(Math.hypot(a[0] - b[0], a[1] - b[1], a[2] - b[2]) / PIECE_OF_COAST));
      const at = (share) => placeOf([0, 1, 2].map((axis) => (1 - share) * a[axis] + share * b[axis]));
      for (let i = 0; i < count; i++) pairs.push([at(i / count), at((i + 1) / count)]);
    }
    return pairs;
  }

  /** Meridians and parallels every 30 degrees, in pieces of three. */
  graticule() {
    const degree = Math.PI / 180;
    const pairs = [];
    for (let lon = 0; lon < 360; lon += 30)
      for (let lat = -90; lat < 90; lat += 3) pairs.push([lat, lat + 3].map((each) => ({ lon: lon * degree, lat: each * degree })));
    for (let lat = -60; lat <= 60; lat += 30)
      for (let lon = 0; lon < 360; lon += 3) pairs.push([lon, lon + 3].map((each) => ({ lon: each * degree, lat: lat * degree })));
    return pairs;
  }
}
