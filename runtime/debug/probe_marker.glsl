// Draws balls at light probes, each made of the six faces of a cube. A point of a ball has the radiance that the
// probe's harmonics give in the direction of its normal.
struct Sign {
  vec4 place_and_radius;
  vec4 group_from_world;
  uint light;
  uint order;
  uint pad[2];
};
layout(std430, binding = 1) readonly buffer Signs { Sign signs[]; };

#ifdef LAMBENT_VERTEX
#include "view_block.glsl"
#include "cube_texel.glsl"

layout(location = 0) out vec3 direction;  // from the centre of the ball, world axes
layout(location = 1) flat out int sign_index;

const int kBallCells = 10;

void main() {
  const vec2 kCorners[6] = vec2[6](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1));
  int quad = gl_VertexID / 6, face = quad / (kBallCells * kBallCells);
  vec2 cell = vec2(quad % kBallCells, quad / kBallCells % kBallCells);
  vec2 st = 2.0 * (cell + kCorners[gl_VertexID % 6]) / float(kBallCells) - 1.0;
  sign_index = gl_InstanceID;
  vec4 place_and_radius = signs[gl_InstanceID].place_and_radius;
  direction = normalize(cubeFaceDirection(face, tan(0.78539816 * st)));
  vec3 place = place_and_radius.xyz + place_and_radius.w * direction;
  gl_Position = clip_from_view * (view_from_world * vec4(place, 1.0));
}
#else
#include "overlay_colors.glsl"

layout(std430, binding = 2) readonly buffer Lights { vec4 lights[]; };
layout(location = 0) in vec3 direction;
layout(location = 1) flat in int sign_index;
layout(location = 0) out vec4 color;

vec3 turned(vec4 turn, vec3 v) { return v + 2.0 * cross(turn.xyz, cross(turn.xyz, v) + turn.w * v); }

vec3 lightAt(uint index) { return lights[index].rgb; }
#include "harmonics.glsl"

void main() {
  Sign sign_of = signs[sign_index];
  vec3 dir = turned(sign_of.group_from_world, normalize(direction));
  color = vec4(shownLight(sumOfHarmonics(dir, sign_of.light, int(sign_of.order), false)), 1.0);
}
#endif
