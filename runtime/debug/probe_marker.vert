// Draws instances of a cube with a ball on top of it, both made of the six faces of a cube.
#include "surface_shared.h"

layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;
};
struct Sign {
  vec4 place_and_radius;
  vec4 group_from_world;
  uint light;
  uint order;
  uint pad[2];
};
layout(std430, binding = 1) readonly buffer Signs { Sign signs[]; };

layout(location = 0) out vec3 direction;  // from the centre of the cube or ball, world axes
layout(location = 1) out vec2 face_place;  // coordinates on the face, for the cube
layout(location = 2) flat out ivec2 face_and_sign;  // the face (-1: the ball) and the index of the sign

const int kCubeVertices = 36, kBallCells = 10;

// Does the same as sh::cubeFaceDirection.
vec3 faceDirection(int face, vec2 st) {
  if (face == 0) return vec3(1.0, -st.y, -st.x);
  if (face == 1) return vec3(-1.0, -st.y, st.x);
  if (face == 2) return vec3(st.x, 1.0, st.y);
  if (face == 3) return vec3(st.x, -1.0, -st.y);
  if (face == 4) return vec3(st.x, -st.y, 1.0);
  return vec3(-st.x, -st.y, -1.0);
}

void main() {
  const vec2 kCorners[6] = vec2[6](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1));
  Sign sign_of = signs[gl_InstanceID];
  float radius = sign_of.place_and_radius.w;
  vec3 place = sign_of.place_and_radius.xyz;
  int vertex = gl_VertexID;
  if (vertex < kCubeVertices) {
    int face = vertex / 6;
    face_place = 2.0 * kCorners[vertex % 6] - 1.0;
    direction = faceDirection(face, face_place);
    face_and_sign = ivec2(face, gl_InstanceID);
    place += 0.75 * radius * direction;
  } else {
    vertex -= kCubeVertices;
    int quad = vertex / 6, face = quad / (kBallCells * kBallCells);
    vec2 cell = vec2(quad % kBallCells, quad / kBallCells % kBallCells);
    vec2 st = 2.0 * (cell + kCorners[vertex % 6]) / float(kBallCells) - 1.0;
    face_place = vec2(0.0);
    direction = normalize(faceDirection(face, tan(0.78539816 * st)));
    face_and_sign = ivec2(-1, gl_InstanceID);
    place += radius * direction + vec3(0.0, 1.75 * radius, 0.0);
  }
  gl_Position = clip_from_view * (view_from_world * vec4(place, 1.0));
}
