// Programs of the graphics card. With MAP they draw Mollweide's map, with PLANE a plane from above, else the globe from
// far above the camera's place.

// `scale` and `shift` bring lengths to the picture, -1 to 1; `copy` draws once more, on the other side, what the rim of
// the map cuts, or the border of one period of the plane.
const PLACING = /* glsl */ `
precision highp float;
uniform vec2 scale;
uniform vec2 shift;
#ifdef MAP
uniform float middle;
uniform float copy;
out vec2 plane;
const float TURN = 6.283185307179586;

vec3 placed(vec4 where) {
  float turn = TURN * floor((where.w - middle) / TURN + 0.5);
  float from = where.w - middle - turn;
  if (copy > 0.5) turn += from > 0.0 ? TURN : -TURN;
  bool far = copy > 0.5 && abs(from) < 0.25 * TURN;
  vec2 at = vec2(0.900316316157106 * (where.x - middle - turn) * where.y, 1.4142135623730951 * where.z);
  return vec3(at, far ? -1.0 : 1.0);
}
#elif defined(PLANE)
uniform vec2 centre;
uniform vec2 periods;
uniform vec2 copy;

vec3 placed(vec4 where) {
  vec2 turn = vec2(0.0);
  for (int axis = 0; axis < 2; axis++) {
    if (periods[axis] == 0.0) continue;
    float from = where[axis + 2] - centre[axis];
    float nearest = periods[axis] * floor(from / periods[axis] + 0.5);
    float other = from > nearest ? periods[axis] : -periods[axis];
    turn[axis] = copy[axis] > 0.5 ? nearest + other : nearest;
  }
  return vec3(where.xy - centre - turn, 1.0);
}
#else
uniform mat3 view;

vec3 placed(vec3 where) {
  return view * where;
}
#endif
`;

// Flat colours: each corner brings the value of its own polygon, looked up in a texture that holds all of a snapshot.
export const PATCH_CORNERS = /* glsl */ `${PLACING}
#if defined(MAP)
in vec4 onMap;
#elif defined(PLANE)
in vec4 place;
#else
in vec3 position;
#endif
in vec2 part;
uniform highp usampler2D values;
uniform int across;
uniform uint missing;
uniform vec2 toTone;
flat out float tone;
flat out float number;
out float within;

void main() {
#if defined(MAP)
  vec3 at = placed(onMap);
  plane = at.xy;
  bool hidden = at.z < 0.0;
#elif defined(PLANE)
  vec3 at = placed(place);
  bool hidden = false;
#else
  vec3 at = placed(position);
  bool hidden = false;
#endif
  int polygon = int(part.x);
  uint value = texelFetch(values, ivec2(polygon % across, polygon / across), 0).r;
  tone = value == missing ? -1.0 : clamp(float(value) * toTone.x + toTone.y, 0.0, 1.0);
  number = part.x;
  within = part.y;
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(at.xy * scale + shift, 0.0, 1.0);
}
`;

// Edges show, and the polygon under the pointer stands out, where polygons are some pixels wide.
export const PATCH_PIXELS = /* glsl */ `
precision highp float;
uniform sampler2D palette;
uniform vec3 land;
uniform float pointed;
uniform float density;
flat in float tone;
flat in float number;
in float within;
out vec4 colour;
#ifdef MAP
in vec2 plane;
#endif

void main() {
  float change = fwidth(within);
#ifdef MAP
  if (dot(plane * plane, vec2(0.125, 0.5)) > 1.0) discard;
#endif
  vec3 paint = tone < 0.0 ? land : texture(palette, vec2((tone * 255.0 + 0.5) / 256.0, 0.5)).rgb;
  float away = within / max(change, 1e-6) / density;
  float shown = 0.45 * smoothstep(4.0, 20.0, 1.0 / max(change, 1e-6) / density);
  paint = mix(paint, vec3(0.0), shown * (1.0 - smoothstep(0.25, 0.9, away)));
  if (number == pointed) paint = mix(paint, away < 1.25 ? vec3(0.0) : vec3(1.0), 1.0 - smoothstep(2.2, 2.8, away));
  colour = vec4(paint, 1.0);
}
`;

// Lines of some pixels' width: a strip of four corners for each piece.
export const LINE_CORNERS = /* glsl */ `${PLACING}
#if defined(MAP) || defined(PLANE)
in vec4 start;
in vec4 end;
#else
in vec3 start;
in vec3 end;
#endif
in vec2 corner;
uniform vec2 pixels;
uniform float width;

void main() {
  vec3 a = placed(start);
  vec3 b = placed(end);
  vec2 first = a.xy * scale + shift;
  vec2 last = b.xy * scale + shift;
  vec2 along = (last - first) * pixels;
  along /= max(length(along), 1e-6);
  vec2 sideways = vec2(-along.y, along.x) * corner.y;
#ifdef MAP
  plane = mix(a.xy, b.xy, corner.x);
#endif
#ifdef PLANE
  // Copies of polygons hold those that the border cuts; of lines, the others are left out here.
  vec2 beyond = 0.5 * abs(a.xy + b.xy) - 0.5 * periods;
  bool hidden = any(greaterThan(copy * beyond, 0.4995 * abs(a.xy - b.xy)));
#else
  bool hidden = min(a.z, b.z) < 0.0;
#endif
  gl_Position = hidden ? vec4(2.0, 2.0, 2.0, 1.0) : vec4(mix(first, last, corner.x) + sideways * width / pixels, 0.0, 1.0);
}
`;

export const LINE_PIXELS = /* glsl */ `
precision highp float;
uniform vec4 ink;
out vec4 colour;
#ifdef MAP
in vec2 plane;
#endif

void main() {
#ifdef MAP
  if (dot(plane * plane, vec2(0.125, 0.5)) > 1.0) discard;
#endif
  colour = ink;
}
`;

// What lies behind: the disc of the globe, or the ellipse of the map.
export const GROUND_CORNERS = /* glsl */ `
precision highp float;
in vec2 corner;
uniform vec2 scale;
uniform vec2 shift;
uniform vec2 half_;
out vec2 plane;

void main() {
  plane = corner;
  gl_Position = vec4(corner * half_ * scale + shift, 0.0, 1.0);
}
`;

export const GROUND_PIXELS = /* glsl */ `
precision highp float;
uniform vec3 land;
in vec2 plane;
out vec4 colour;

void main() {
  float beyond = length(plane) - 1.0;
  float soft = fwidth(beyond);
  colour = vec4(land, 1.0 - smoothstep(-soft, soft, beyond));
}
`;
