// Makes the sky that all points share: for each texel of the cube in world axes, the mean of the environment
// maps over subsamples² directions, plus the constants, without suns. It also makes the weights that project
// each texel to harmonics. For uniform light these are the weights of sh::cubeWeights. A sun or a window in
// an environment map is smaller than a texel, and its place within the texel must not be lost. With d the
// mean direction of the texel's light, s² its variance, d_u and s_u² those of uniform light, and y(d, s) =
// exp(-l(l+1) s² / 4) y(d) the mean of y over a small spot, the weight is
//  Omega y(d, s) + s² / s_u² (w - Omega y(d_u, s_u))
#include "capture_shared.h"

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
layout(std430, binding = kBindWeights) readonly buffer Weights { float weights[]; };
layout(std430, binding = kBindSkyWeights) buffer SkyWeights { float sky_weights[]; };

// Does the same as sh::cubeFaceDirection.
vec3 faceDirection(uint face, float sc, float tc) {
  switch (face) {
    case 0u: return vec3(1.0, -tc, -sc);
    case 1u: return vec3(-1.0, -tc, sc);
    case 2u: return vec3(sc, 1.0, tc);
    case 3u: return vec3(sc, -1.0, -tc);
    case 4u: return vec3(sc, -tc, 1.0);
    default: return vec3(-sc, -tc, -1.0);
  }
}

// Returns the factor f_l in the recurrence of sh/basis.hpp: y_l = z f_l y_(l-1) - f_l / f_(l-1) y_(l-2), all
// of the same m.
float zFactor(float l, float m) {
  return sqrt((4.0 * l * l - 1.0) / (l * l - m * m));
}

// Adds `scale` times the mean of y over a spot about d to the texel's weights.
void addSpot(uint first_weight, vec3 d, float variance, float scale) {
  float sectoral = 0.28209479177387814, c = 1.0, s = 0.0;
  for (int m = 0; m < ORDER; ++m) {
    if (m > 0) {
      float next = c * d.x - s * d.y;
      s = s * d.x + c * d.y;
      c = next;
      sectoral *= sqrt(float(2 * m + 1) / float(2 * m)) * (m == 1 ? sqrt(2.0) : 1.0);
    }
    float y = sectoral, before = 0.0;
    for (int l = m; l < ORDER; ++l) {
      if (l > m) {
        float f = zFactor(float(l), float(m));
        float next = f * d.z * y - (l > m + 1 ? f / zFactor(float(l - 1), float(m)) * before : 0.0);
        before = y;
        y = next;
      }
      float value = scale * exp(-0.25 * float(l * (l + 1)) * variance) * y;
      uint at = first_weight + uint(l * (l + 1));
      if (m == 0) {
        sky_weights[at] += value;
      } else {
        sky_weights[at + uint(m)] += value * c;
        sky_weights[at - uint(m)] += value * s;
      }
    }
  }
}

void main() {
  uint texel = gl_GlobalInvocationID.x;
  if (texel >= 6u * size * size) return;
  uint face = texel / (size * size), x = texel % size, y = texel / size % size;
  float step = 2.0 / float(size * subsamples);
  vec3 middle = normalize(faceDirection(face, (float(x) + 0.5) * step * float(subsamples) - 1.0,
                                        (float(y) + 0.5) * step * float(subsamples) - 1.0));
  vec3 sum = vec3(0.0), even_offset = vec3(0.0), offset = vec3(0.0);
  float brightness = 0.0, texel_sr = 0.0;
  for (uint j = 0u; j < subsamples; ++j)
    for (uint i = 0u; i < subsamples; ++i) {
      float sc = (float(x * subsamples + i) + 0.5) * step - 1.0;
      float tc = (float(y * subsamples + j) + 0.5) * step - 1.0;
      // Equal areas of the face are unequal solid angles; over one of 16 texels they differ by up to a tenth.
      float subsample_sr = pow(1.0 + sc * sc + tc * tc, -1.5);
      vec3 direction = normalize(faceDirection(face, sc, tc)), in_light = light_from_world * direction;
      vec3 radiance = constant_radiance;
      if (shares.x > 0.0) radiance += shares.x * textureLod(first_probes, in_light, levels.x).rgb;
      if (shares.y > 0.0) radiance += shares.y * textureLod(second_probes, in_light, levels.y).rgb;
      sum += subsample_sr * radiance;
      texel_sr += subsample_sr;
      float bright = subsample_sr * max(radiance.r + radiance.g + radiance.b, 0.0);
      brightness += bright;
      offset += bright * (direction - middle);
      even_offset += subsample_sr * (direction - middle);
    }
  sky[texel] = vec4(sum / texel_sr, 0.0);

  uint first_weight = texel * uint((ORDER * ORDER + 3) / 4 * 4);
  even_offset /= texel_sr;
  // With a single subsample nothing is known about the inside of the texel, and black counts as uniform.
  bool even = subsamples == 1u || !(brightness > 0.0);
  offset = even ? even_offset : offset / brightness;
  // The variance is 1 - |mean direction|², written so that it does not cancel.
  float even_variance = -dot(even_offset, 2.0 * middle + even_offset);
  float variance = clamp(-dot(offset, 2.0 * middle + offset), 0.0, even_variance);
  float share = even ? 1.0 : variance / even_variance;
  float solid_angle = weights[first_weight] / 0.28209479177387814;
  for (uint i = 0u; i < uint(ORDER * ORDER); ++i) sky_weights[first_weight + i] = share * weights[first_weight + i];
  if (even) return;
  addSpot(first_weight, normalize(middle + offset), variance, solid_angle);
  addSpot(first_weight, normalize(middle + even_offset), even_variance, -share * solid_angle);
}
