// The shaders: one way to move vertices for surfaces, edges and picking, so that what is picked is what is seen.

const TABLES = /* glsl */ `
precision highp float;
precision highp int;
precision highp sampler2D;
`;

// Where a vertex goes: with its first body and, on top of that, as a beam does whose second end follows the second body.
// The same as Mesh.displacement in src/flexstage/show/viewer/mesh.py.
const MOVE = /* glsl */ `
in vec3 position;
in float part;
in float carrier;
in float station;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform sampler2D twists;    // 2 a body: translation, rotation
uniform sampler2D carriers;  // 3 a carrier: its bodies, its first end, its second
uniform sampler2D stations;  // 2 a station: share and deflections, slopes
uniform sampler2D paints;    // 1 a part: colour, opacity; -1 where it is hidden
uniform sampler2D poses;     // 2 a row: displacement, rotation vector; bodies first, then 12 nodes along each carrier of two bodies
uniform float factor;
uniform float finite;
flat out float partNumber;
flat out vec4 paint;
out vec3 seen;
out vec3 place;

vec4 row(sampler2D table, int index) {
  int width = textureSize(table, 0).x;
  return texelFetch(table, ivec2(index % width, index / width), 0);
}

vec3 displacement() {
  int c = int(carrier);
  vec2 bodies = row(carriers, 3 * c).xy;
  int one = int(bodies.x), other = int(bodies.y);
  vec3 t = row(twists, 2 * one).xyz, w = row(twists, 2 * one + 1).xyz;
  vec3 rigid = t + cross(w, position);
  if (one == other) return rigid;
  vec3 first = row(carriers, 3 * c + 1).xyz, second = row(carriers, 3 * c + 2).xyz;
  vec3 axis = second - first;
  float size = length(axis);
  if (size <= 0.0) return rigid;
  axis /= size;
  int s = int(station);
  vec3 shares = row(stations, 2 * s).xyz;
  vec2 slopes = row(stations, 2 * s + 1).xy;
  vec3 turn = row(twists, 2 * other + 1).xyz - w;
  vec3 offset = row(twists, 2 * other).xyz - t + cross(turn, second);
  vec3 along = axis * dot(axis, offset), spin = axis * dot(axis, turn), lean = cross(turn, axis);
  vec3 line = along * shares.x + (offset - along) * shares.y + lean * size * shares.z;
  vec3 slope = (offset - along) / size * slopes.x + lean * slopes.y;
  vec3 centre = mix(first, second, shares.x);
  return rigid + line + cross(cross(axis, slope) + spin * shares.x, position - centre);
}

vec3 rotated(vec3 w, vec3 v) {
  float angle = length(w);
  if (angle < 1e-6) return v + cross(w, v);
  vec3 axis = w / angle;
  return v * cos(angle) + cross(axis, v) * sin(angle) + axis * dot(axis, v) * (1.0 - cos(angle));
}

// Large displacements: bodies rotate about the origin, bent pieces follow their nodes.
vec3 posed() {
  int c = int(carrier);
  vec3 link = row(carriers, 3 * c).xyz;
  if (link.x == link.y) return row(poses, 2 * int(link.x)).xyz + rotated(row(poses, 2 * int(link.x) + 1).xyz, position);
  float share = row(stations, 2 * int(station)).x;
  float along = clamp(share, 0.0, 1.0) * 11.0, node = min(floor(along), 10.0);
  int at = 2 * (int(link.z) + int(node));
  vec3 shift = mix(row(poses, at).xyz, row(poses, at + 2).xyz, along - node);
  vec3 turn = mix(row(poses, at + 1).xyz, row(poses, at + 3).xyz, along - node);
  vec3 centre = mix(row(carriers, 3 * c + 1).xyz, row(carriers, 3 * c + 2).xyz, share);
  return centre + shift + rotated(turn, position - centre);
}

vec4 seat() {
  partNumber = part;
  paint = row(paints, int(part));
  place = finite > 0.5 ? posed() : position + factor * displacement();
  vec4 view = modelViewMatrix * vec4(place, 1.0);
  seen = view.xyz;
  return projectionMatrix * view;
}
const vec4 NOWHERE = vec4(2.0, 2.0, 2.0, 1.0);
`;

const CUT = /* glsl */ `
flat in float partNumber;
flat in vec4 paint;
in vec3 seen;
in vec3 place;
uniform vec4 plane;  // cut away in front of it: dot(plane.xyz, p) > plane.w
out vec4 colour;
void cut() { if (dot(plane.xyz, place) > plane.w) discard; }
`;

export const surfaceVertex = `${TABLES}${MOVE}
uniform float translucent;
void main() {
  vec4 at = seat();
  bool shown = paint.a >= 0.0 && (paint.a < 1.0) == (translucent > 0.5);
  gl_Position = shown ? at : NOWHERE;
}`;

// Flat faces: the normal is that of the moved triangle. A face seen from behind is the inside of a cut, drawn evenly and darker.
export const surfaceFragment = `${TABLES}${CUT}
uniform float opacity;
void main() {
  cut();
  vec3 normal = normalize(cross(dFdx(seen), dFdy(seen)));
  float light = 0.55 + 0.45 * max(0.0, dot(normal, normalize(vec3(-0.35, 0.55, 0.76))));
  colour = vec4(paint.rgb * (gl_FrontFacing ? light : 0.42), paint.a * opacity);
}`;

export const edgeVertex = `${TABLES}${MOVE}
void main() {
  vec4 at = seat();
  gl_Position = paint.a >= 0.0 ? at : NOWHERE;
}`;

export const edgeFragment = `${TABLES}${CUT}
uniform vec4 ink;
void main() {
  cut();
  colour = vec4(ink.rgb, ink.a);
}`;

// Part number plus one in two bytes; nothing is 0.
export const pickFragment = `${TABLES}${CUT}
void main() {
  cut();
  float number = partNumber + 1.0;
  colour = vec4(mod(number, 256.0) / 255.0, floor(number / 256.0) / 255.0, 0.0, 1.0);
}`;

export const plainVertex = `${TABLES}
in vec3 position;
in vec3 normal;
uniform mat4 modelViewMatrix;
uniform mat4 projectionMatrix;
uniform mat3 normalMatrix;
out float light;
void main() {
  light = 0.7 + 0.3 * max(0.0, normalize(normalMatrix * normal).z);
  gl_Position = projectionMatrix * modelViewMatrix * vec4(position, 1.0);
}`;

export const plainFragment = `${TABLES}
in float light;
uniform vec3 tint;
out vec4 colour;
void main() { colour = vec4(tint * light, 1.0); }`;
