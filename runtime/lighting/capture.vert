// Places a corner of a body's triangle in one tile of the atlas. Depth is reversed and has no far plane: near
// / w, whose relative precision is the same at all distances. Clip distances cut at the edges of the tile.
#include "capture_shared.h"

layout(binding = kUnitVertices) uniform usamplerBuffer vertices;
layout(binding = kUnitDraws) uniform usamplerBuffer draws;
layout(location = 1) uniform float depth;  // 1, or a little less for dark sides, which lose against bright ones
                                           // in the same place
layout(location = 0) uniform vec2 clip_from_pixel;  // pixel * clip_from_pixel - 1 is the pixel's first edge
                                                    // in clip space

out gl_PerVertex {
  vec4 gl_Position;
  float gl_ClipDistance[4];
};
layout(location = 0) flat out uint surface_id;

void main() {
  uint index = uint(gl_VertexID);
  int draw = int((index >> kVertexBits) * kDrawTexels);
  uvec4 tile = texelFetch(draws, draw + 3);
  uvec4 vertex = texelFetch(vertices, int(tile.x + (index & ((1u << kVertexBits) - 1u))));
  vec4 position = vec4(uintBitsToFloat(vertex.xyz), 1.0);
  float x = dot(uintBitsToFloat(texelFetch(draws, draw)), position);
  float y = dot(uintBitsToFloat(texelFetch(draws, draw + 1)), position);
  float w = dot(uintBitsToFloat(texelFetch(draws, draw + 2)), position);
  vec2 first = vec2(tile.yz & 0xffffu) * clip_from_pixel - 1.0, end = vec2(tile.yz >> 16u) * clip_from_pixel - 1.0;
  gl_Position = vec4(x, y, depth, w);
  gl_ClipDistance[0] = x - first.x * w;
  gl_ClipDistance[1] = end.x * w - x;
  gl_ClipDistance[2] = y - first.y * w;
  gl_ClipDistance[3] = end.y * w - y;
  surface_id = depth < 1.0 ? kBlackId : vertex.w;
}
