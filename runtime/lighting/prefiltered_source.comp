// Prepares the sky for prefiltering: radiance times the solid angle of the texel, and the solid angle in
// alpha. The mip levels of both give true means; those of radiance alone would weight the texels along the
// edges of a face up to five times too much.
#include "prefiltered_shared.h"
#include "cube_texel.glsl"

layout(local_size_x = kReflectedGroup, local_size_y = kReflectedGroup) in;
layout(location = 0) uniform int size;
layout(binding = 0) uniform samplerCube sky;
layout(binding = 0, rgba16f) writeonly uniform imageCube weighted;

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (texel.x >= size || texel.y >= size) return;
  vec3 direction = cubeTexelDirection(texel, size);
  float weight = pow(dot(direction, direction), -1.5);  // relative to a texel in the middle of a face
  imageStore(weighted, texel, vec4(weight * textureLod(sky, direction, 0.0).rgb, weight));
}
