// The two views, in radii of the sphere: the globe from far above a place, and Mollweide's equal-area map round it.

export const TURN = 2 * Math.PI;
const ROOT = Math.SQRT2;
const STRETCH = (2 * ROOT) / Math.PI;

export const clamp = (value, low, high) => Math.min(Math.max(value, low), high);

/** An angle within half a turn of zero. */
export const aboutZero = (angle) => angle - TURN * Math.round(angle / TURN);

/** Unit vector of a place, radians. */
export const pointOf = (lon, lat) => [Math.cos(lat) * Math.cos(lon), Math.cos(lat) * Math.sin(lon), Math.sin(lat)];

export const placeOf = ([x, y, z]) => ({ lon: Math.atan2(y, x), lat: Math.atan2(z, Math.hypot(x, y)) });

/** The angle t of Mollweide's map, 2 t + sin 2 t = pi sin(latitude), by Newton's method. */
export function mollweideAngle(lat) {
  if (Math.PI / 2 - Math.abs(lat) < 1e-7) return lat;
  const aim = Math.PI * Math.sin(lat);
  let t = 0.9 * lat;
  for (let i = 0; i < 30; i++) {
    const change = (2 * t + Math.sin(2 * t) - aim) / (2 + 2 * Math.cos(2 * t));
    t = clamp(t - change, -Math.PI / 2, Math.PI / 2);
    if (Math.abs(change) < 1e-12) break;
  }
  return t;
}

/** Rows: right, up and towards the viewer above the camera's place. */
export function axesOf({ lon, lat }) {
  const [sinLon, cosLon, sinLat, cosLat] = [Math.sin(lon), Math.cos(lon), Math.sin(lat), Math.cos(lat)];
  return [
    [-sinLon, cosLon, 0],
    [-sinLat * cosLon, -sinLat * sinLon, cosLat],
    [cosLat * cosLon, cosLat * sinLon, sinLat],
  ];
}

export const PROJECTIONS = {
  globe: {
    width: 2,
    height: 2,
    /** Middle of the picture on the view. */
    middle: () => [0, 0],
    /** The place seen at a point of the view, or null beyond the rim. */
    place(x, y, camera) {
      const square = x * x + y * y;
      if (square > 1) return null;
      const [right, up, towards] = axesOf(camera);
      const z = Math.sqrt(1 - square);
      return placeOf([0, 1, 2].map((k) => x * right[k] + y * up[k] + z * towards[k]));
    },
  },
  map: {
    width: 4 * ROOT,
    height: 2 * ROOT,
    /** The camera's latitude, but no further than where the map fills the picture, `half` radii high from there. */
    middle(camera, half) {
      const furthest = Math.max(0, ROOT - half);
      return [0, clamp(ROOT * Math.sin(mollweideAngle(camera.lat)), -furthest, furthest)];
    },
    place(x, y, camera) {
      if (x * x / 8 + y * y / 2 > 1) return null;
      const t = Math.asin(clamp(y / ROOT, -1, 1));
      const lon = x / (STRETCH * Math.max(Math.cos(t), 1e-9));
      const lat = Math.asin(clamp((2 * t + Math.sin(2 * t)) / Math.PI, -1, 1));
      return { lon: aboutZero(camera.lon + lon), lat };
    },
  },
};
