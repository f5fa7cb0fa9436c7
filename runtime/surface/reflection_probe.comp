// The kernels that make reflection probes: LAMBENT_STORE takes what was drawn, the other one filters it.
#include "reflection_probes_shared.h"
#include "cube_texel.glsl"

layout(local_size_x = kProbeGroup, local_size_y = kProbeGroup) in;

#ifdef LAMBENT_STORE
// Takes a face that was drawn into a cube: what is seen, and 1 / distance. Both pictures have one pixel per texel. What
// is seen is stored once more, times the texel's solid angle, for the mip levels that the filter looks up.
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
#else
// Computes one mip level of a probe: what a mirror of some roughness shows, each texel being the mean over the lobe about
// its direction. The lobe is that of the prefiltered environment (prefiltered_environment.comp), sampled in equal
// shares, each at a mip level that matches its width.
layout(location = 0) uniform int size;         // texels along the level's edge
layout(location = 1) uniform vec2 lobe;        // alpha, scale
layout(location = 2) uniform int shares;
layout(location = 3) uniform int first_layer;  // probe * 6
layout(binding = 0) uniform samplerCube weighted;
layout(binding = 1) uniform samplerCube weights;
layout(binding = 0, rgba16f) writeonly uniform imageCubeArray images;
layout(std430, binding = kBindProbeLobe) readonly buffer Lobe { float angles[]; };

const float kPi = 3.14159265358979, kGoldenAngle = 2.39996323;

float density(float cos_theta) {
  float root = 0.5 * (1.0 + cos_theta) * (lobe.x * lobe.x - 1.0) + 1.0;
  return lobe.y * max(cos_theta, 0.0) / (root * root);
}

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (texel.x >= size || texel.y >= size) return;
  mat3 frame = frameAbout(normalize(cubeTexelDirection(texel, size)));
  float texels = float(textureSize(weighted, 0).x), texel_angle = 4.0 * kPi / (6.0 * texels * texels);
  vec4 sum = vec4(0.0);
  for (int i = 0; i < shares; ++i) {
    float theta = angles[(2 * i + 1) * int(kProbeShares) / (2 * shares)], phi = kGoldenAngle * float(i);
    vec3 direction = frame * vec3(sin(theta) * vec2(cos(phi), sin(phi)), cos(theta));
    float wide = 1.0 / (float(shares) * max(density(cos(theta)), 1e-6));
    float level = max(0.5 * log2(wide / texel_angle) + 0.5, 0.0);
    sum += textureLod(weighted, direction, level) / textureLod(weights, direction, level).r;
  }
  imageStore(images, ivec3(texel.xy, first_layer + texel.z), sum / float(shares));
}
#endif
