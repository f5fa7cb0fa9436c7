// Computes how a rough mirror shows the sky of one set of lights: one mip level of a cube map in the lights'
// own frame, each texel being the mean over the lobe about its direction. Environment maps are sampled in
// equal shares of the lobe, each share at a mip level that matches its width. Discs of suns are added
// exactly, because such samples would miss them.
#include "prefiltered_shared.h"
#include "cube_texel.glsl"

layout(local_size_x = kReflectedGroup, local_size_y = kReflectedGroup) in;
layout(location = 0) uniform int size;    // texels along the level's edge
layout(location = 1) uniform vec2 lobe;   // alpha, scale; alpha 0: a mirror
layout(location = 2) uniform int shares;  // number of samples of the lobe that look at the sky
layout(location = 3) uniform uint disc_count;
layout(binding = 0) uniform samplerCube sky;  // from prefiltered_source.comp: radiance times solid angle, and
                                              // the solid angle
layout(binding = 0, rgba16f) writeonly uniform imageCube reflected;
layout(std430, binding = kBindLobe) readonly buffer Lobe {
  float angles[];
};
layout(std430, binding = kBindDiscs) readonly buffer Discs {
  ReflectedDisc discs[];
};

const float kPi = 3.14159265358979;
const float kGoldenAngle = 2.39996323;
const int kAllShares = 256, kDiscPoints = 48;
const float kLargestHalf = 65504.0;

// Returns the mean radiance over what the mip level covers there.
vec3 meanOfSky(vec3 direction, float level) {
  vec4 weighted = textureLod(sky, direction, level);
  return weighted.rgb / weighted.a;
}

float density(float cos_theta) {
  float root = 0.5 * (1.0 + cos_theta) * (lobe.x * lobe.x - 1.0) + 1.0;
  return lobe.y * max(cos_theta, 0.0) / (root * root);
}

vec3 skyThrough(mat3 frame) {
  float texels = float(textureSize(sky, 0).x);
  float texel_angle = 4.0 * kPi / (6.0 * texels * texels);
  if (lobe.x == 0.0) return meanOfSky(frame[2], max(log2(texels / float(size)), 0.0));
  vec3 sum = vec3(0.0);
  for (int i = 0; i < shares; ++i) {
    float theta = angles[(2 * i + 1) * kAllShares / (2 * shares)], phi = kGoldenAngle * float(i);
    vec3 direction = frame * vec3(sin(theta) * vec2(cos(phi), sin(phi)), cos(theta));
    float wide = 1.0 / (float(shares) * max(density(cos(theta)), 1e-6));
    sum += meanOfSky(direction, max(0.5 * log2(wide / texel_angle) + 0.5, 0.0));
  }
  return sum / float(shares);
}

// Returns the share of the lobe that a disc covers whose centre is `apart` radians from the lobe's axis.
float shareOfDisc(float apart, float radius) {
  if (lobe.x == 0.0) return clamp((radius - apart) * float(size) / (0.5 * kPi) + 0.5, 0.0, 1.0);
  if (radius < 0.5 * angles[kAllShares / 2]) {
    // The lobe is wider than the disc, so the disc is sampled.
    float sum = 0.0, least = cos(radius);
    for (int i = 0; i < kDiscPoints; ++i) {
      float cosine = 1.0 - (float(i) + 0.5) / float(kDiscPoints) * (1.0 - least),
            phi = kGoldenAngle * float(i);
      sum += density(cosine * cos(apart) + sqrt(1.0 - cosine * cosine) * sin(apart) * cos(phi));
    }
    return sum * 2.0 * kPi * (1.0 - least) / float(kDiscPoints);
  }
  // Otherwise the lobe is sampled in rings, each weighted with the part of it that the disc covers.
  float sum = 0.0;
  for (int i = 0; i < kAllShares; ++i) {
    float theta = angles[i];
    if (theta + apart <= radius) {
      sum += 1.0;
    } else if (abs(theta - apart) < radius) {
      float cosine = (cos(radius) - cos(theta) * cos(apart)) / max(sin(theta) * sin(apart), 1e-9);
      sum += acos(clamp(cosine, -1.0, 1.0)) / kPi;
    }
  }
  return sum / float(kAllShares);
}

void main() {
  ivec3 texel = ivec3(gl_GlobalInvocationID);
  if (texel.x >= size || texel.y >= size) return;
  mat3 frame = frameAbout(normalize(cubeTexelDirection(texel, size)));
  vec3 sum = skyThrough(frame);
  for (uint i = 0u; i < disc_count; ++i) {
    vec3 to_disc = discs[i].direction_and_radius.xyz;
    float apart = atan(length(cross(frame[2], to_disc)), dot(frame[2], to_disc));
    sum += shareOfDisc(apart, discs[i].direction_and_radius.w) * discs[i].radiance.rgb;
  }
  imageStore(reflected, texel, vec4(min(sum, vec3(kLargestHalf)), 0.0));
}
