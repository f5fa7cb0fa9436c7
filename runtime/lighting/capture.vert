// A corner of a body's triangle in one tile of the atlas. Depth is reversed and has no far end: near / w, whose
// relative precision is the same at all distances.
#include "capture_shared.h"

layout(std430, binding = kBindVertices) readonly buffer Vertices { uvec4 vertices[]; };
layout(std430, binding = kBindDraws) readonly buffer Draws { DrawRecord draws[]; };

out gl_PerVertex {
  vec4 gl_Position;
  float gl_ClipDistance[4];
};
layout(location = 0) flat out uint surface_id;

void main() {
  uint index = uint(gl_VertexID);
  DrawRecord draw = draws[index >> kVertexBits];
  uvec4 vertex = vertices[draw.first_vertex + (index & ((1u << kVertexBits) - 1u))];
  vec4 position = vec4(uintBitsToFloat(vertex.xyz), 1.0);
  float x = dot(draw.face_x, position), y = dot(draw.face_y, position), w = dot(draw.face_w, position);
  gl_Position = vec4(x * draw.place.x + w * draw.place.y, y * draw.place.z + w * draw.place.w, draw.near_m, w);
  gl_ClipDistance[0] = x - draw.window.x * w;
  gl_ClipDistance[1] = draw.window.y * w - x;
  gl_ClipDistance[2] = y - draw.window.z * w;
  gl_ClipDistance[3] = draw.window.w * w - y;
  surface_id = vertex.w;
}
