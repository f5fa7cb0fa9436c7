// Makes the sky that all points share: for each texel of the cube in world axes, the mean of the environment
// maps over subsamples² directions, plus the constants, without suns.
#include "capture_shared.h"
#include "cube_texel.glsl"

layout(local_size_x = kWorkGroupSize) in;
layout(location = 0) uniform mat3 light_from_world;
layout(location = 1) uniform uint size;
layout(location = 2) uniform uint subsamples;
layout(location = 3) uniform vec2 levels;  // mip level for each set's environment maps at which two
                                           // subsamples span a texel
layout(location = 4) uniform vec3 constant_radiance;
layout(location = 5) uniform vec2 shares;  // factors on the environment maps of the two sets
layout(binding = kUnitFirstProbes) uniform samplerCube first_probes;
layout(binding = kUnitSecondProbes) uniform samplerCube second_probes;
layout(std430, binding = kBindSky) writeonly buffer Sky { vec4 sky[]; };

void main() {
  uint texel = gl_GlobalInvocationID.x;
  if (texel >= 6u * size * size) return;
  uint face = texel / (size * size), x = texel % size, y = texel / size % size;
  float step = 2.0 / float(size * subsamples);
  vec3 sum = vec3(0.0);
  float texel_sr = 0.0;
  for (uint j = 0u; j < subsamples; ++j)
    for (uint i = 0u; i < subsamples; ++i) {
      float sc = (float(x * subsamples + i) + 0.5) * step - 1.0;
      float tc = (float(y * subsamples + j) + 0.5) * step - 1.0;
      // Equal areas of the face are unequal solid angles; over one of 16 texels they differ by up to a tenth.
      float subsample_sr = pow(1.0 + sc * sc + tc * tc, -1.5);
      vec3 in_light = light_from_world * normalize(cubeFaceDirection(int(face), vec2(sc, tc)));
      vec3 radiance = constant_radiance;
      if (shares.x > 0.0) radiance += shares.x * textureLod(first_probes, in_light, levels.x).rgb;
      if (shares.y > 0.0) radiance += shares.y * textureLod(second_probes, in_light, levels.y).rgb;
      sum += subsample_sr * radiance;
      texel_sr += subsample_sr;
    }
  sky[texel] = vec4(sum / texel_sr, 0.0);
}
