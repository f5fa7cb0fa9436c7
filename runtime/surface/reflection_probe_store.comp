// Takes a face that was drawn into a cube: what is seen, and 1 / distance. Both pictures have one pixel per texel. What
// is seen is stored once more, times the texel's solid angle, for the mip levels that the filter looks up.
#include "reflection_probes_shared.h"
#include "cube_texel.glsl"

layout(local_size_x = kProbeGroup, local_size_y = kProbeGroup) in;
layout(location = 0) uniform int face;
layout(location = 1) uniform int image_layer;     // probe * 6 + face
layout(location = 2) uniform int distance_layer;
layout(location = 3) uniform vec2 projection;     // depth = x / (2 d - 1 + y), with d from the depth buffer
layout(binding = 0) uniform sampler2D drawn;
layout(binding = 1) uniform sampler2D drawn_depth;
layout(binding = 0, rgba16f) writeonly uniform imageCubeArray images;
layout(binding = 1, rgba16f) writeonly uniform imageCube weighted;
layout(binding = 2, r16f) writeonly uniform imageCube weights;

const float kLargestHalf = 65504.0;

void main() {
  ivec2 texel = ivec2(gl_GlobalInvocationID.xy);
  int size = imageSize(weighted).x;
  if (texel.x >= size || texel.y >= size) return;
  vec3 direction = cubeTexelDirection(ivec3(texel, face), size);
  vec4 seen = texelFetch(drawn, texel, 0);
  seen = vec4(min(seen.rgb, vec3(kLargestHalf)), clamp(seen.a, 0.0, 1.0));
  float depth = texelFetch(drawn_depth, texel, 0).r;
  float inverse = depth < 1.0 ? (2.0 * depth - 1.0 + projection.y) / projection.x / length(direction) : 0.0;
  float weight = pow(dot(direction, direction), -1.5);  // relative to a texel in the middle of a face
  imageStore(images, ivec3(texel, image_layer), seen);
  imageStore(images, ivec3(texel, distance_layer), vec4(inverse));
  imageStore(weighted, ivec3(texel, face), weight * seen);
  imageStore(weights, ivec3(texel, face), vec4(weight));
}
