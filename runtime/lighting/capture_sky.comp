// The sky as all points see it: per texel of the cube in world axes the mean of the environment maps over subsamples²
// directions, plus the constants; suns are not in it. And per texel the weights with which it goes to harmonics. Where
// light is even they are those of sh::cubeWeights; where a environment map has a sun or a window, smaller than a texel, its
// place within the texel is known here and must not be lost. With d the mean direction of the texel's light, s² its
// variance, d_u and s_u² those of even light, and y(d, s) = exp(-l(l+1) s² / 4) y(d), the mean of y over a small spot:
//   Omega y(d, s) + s² / s_u² (w - Omega y(d_u, s_u))
#include "capture_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(location = 0) uniform mat3 light_from_world;
layout(location = 1) uniform uint size;
layout(location = 2) uniform uint subsamples;
layout(location = 3) uniform vec2 levels;  // of the mip maps of both sets' environment maps: a texel to two subsamples
layout(location = 4) uniform vec3 constant_radiance;
layout(location = 5) uniform vec2 shares;  // of the sets' environment maps
layout(binding = kUnitFirstProbes) uniform samplerCube first_probes;
layout(binding = kUnitSecondProbes) uniform samplerCube second_probes;
layout(std430, binding = kBindSky) writeonly buffer Sky { vec4 sky[]; };
layout(std430, binding = kBindWeights) readonly buffer Weights { float weights[]; };
layout(std430, binding = kBindSkyWeights) buffer SkyWeights { float sky_weights[]; };

// sh::cubeFaceDirection
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

// K of sh/basis.hpp's recurrence: y_l = z f_l y_(l-1) - f_l / f_(l-1) y_(l-2), all of the same m.
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
      // Equal areas of the face are unequal solid angles; over one texel of 16 by as much as a tenth.
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
  // A single subsample tells nothing of what is within, and black is even.
  bool even = subsamples == 1u || !(brightness > 0.0);
  offset = even ? even_offset : offset / brightness;
  // 1 - |mean direction|², which is the variance, without its cancellation.
  float even_variance = -dot(even_offset, 2.0 * middle + even_offset);
  float variance = clamp(-dot(offset, 2.0 * middle + offset), 0.0, even_variance);
  float share = even ? 1.0 : variance / even_variance;
  float solid_angle = weights[first_weight] / 0.28209479177387814;
  for (uint i = 0u; i < uint(ORDER * ORDER); ++i) sky_weights[first_weight + i] = share * weights[first_weight + i];
  if (even) return;
  addSpot(first_weight, normalize(middle + offset), variance, solid_angle);
  addSpot(first_weight, normalize(middle + even_offset), even_variance, -share * solid_angle);
}
