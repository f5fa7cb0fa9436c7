// Marches each pixel's ray through the volumes, up to the surface behind them. With one sample per pixel it draws
// into the picture itself. With several it stores what lies before the pixel's nearest and farthest sample; so a ray is
// marched once, and edges in mist have no halo. With LAMBENT_COMPOSITE it then composites that over the picture: each
// sample takes what was gathered up to the pixel's nearest or farthest sample, whichever is closer to it.
#include "volume_shared.h"

layout(location = 0) uniform vec4 scale;  // of clip_from_view: [0][0], [1][1], [2][2], [3][2]
layout(location = 3) uniform bool perspective;

// Returns view-space z of a depth in clip space, -1..1. It is negative in front of the eye.
float viewZ(float depth) { return perspective ? -scale.w / (depth + scale.z) : (depth - scale.w) / scale.z; }

#ifdef LAMBENT_SAMPLES
layout(binding = kUnitDepth) uniform sampler2DMS depth_picture;

// Returns the depths of the pixel's nearest and farthest sample.
vec2 depthsAt(ivec2 pixel) {
  vec2 depths = vec2(1.0, 0.0);
  for (int i = 0; i < LAMBENT_SAMPLES; ++i) {
    float depth = texelFetch(depth_picture, pixel, i).r;
    depths = vec2(min(depths.x, depth), max(depths.y, depth));
  }
  return depths;
}
#else
layout(binding = kUnitDepth) uniform sampler2D depth_picture;
#endif

#ifdef LAMBENT_COMPOSITE
layout(binding = kUnitMarched) uniform sampler2DArray marched;
layout(location = 0) out vec4 color;

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 depths = depthsAt(pixel);
  float own = viewZ(2.0 * texelFetch(depth_picture, pixel, gl_SampleID).r - 1.0);
  bool before = viewZ(2.0 * depths.x - 1.0) - own <= own - viewZ(2.0 * depths.y - 1.0);
  vec4 gathered = texelFetch(marched, ivec3(pixel, before ? 0 : 1), 0);
  if (gathered == vec4(0.0, 0.0, 0.0, 1.0)) discard;  // leaves the pixel as it was
  color = vec4(gathered.rgb, 1.0 - gathered.a);
}
#else
layout(std430, binding = kBindMarch) readonly buffer March { MarchRecord records[]; };
layout(std430, binding = kBindBlocks) readonly buffer Blocks { float blocks[]; };
layout(binding = kUnitDensity) uniform sampler3D densities[LAMBENT_VOLUMES];
layout(binding = kUnitDensity + LAMBENT_VOLUMES) uniform sampler3D lights[LAMBENT_VOLUMES];
layout(location = 1) uniform vec4 offset;  // of clip_from_view: [2][0], [2][1], [3][0], [3][1]
layout(location = 2) uniform vec2 picture_size;
layout(location = 4) uniform float step_voxels;

#include "volume_march.glsl"

float densityAt(int v, vec3 place) { return textureLod(densities[v], place, 0.0).r; }
vec4 lightAt(int v, vec3 place) { return textureLod(lights[v], place, 0.0); }
float blockMaximumAt(uint block) { return blocks[block]; }

#if LAMBENT_STOPS == 1
layout(location = 0) out vec4 color;
#else
layout(location = 0) out vec4 near;
layout(location = 1) out vec4 far;
#endif

// Returns a number in (0, 1] that depends on the pixel and not on the frame. The hash is O'Neill's PCG as in
// Jarzynski and Olano 2020.
float jitterOf(uvec2 pixel) {
  uint state = pixel.x + 65536u * pixel.y;
  state = state * 747796405u + 2891336453u;
  uint word = ((state >> ((state >> 28u) + 4u)) ^ state) * 277803737u;
  word = (word >> 22u) ^ word;
  return (float(word >> 8u) + 1.0) / 16777216.0;
}

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  vec2 clip = (vec2(pixel) + 0.5) / picture_size * 2.0 - 1.0;
  vec3 origin = vec3(0.0), direction = vec3(0.0, 0.0, -1.0);
  if (perspective)
    direction = normalize(vec3((clip + offset.xy) / scale.xy, -1.0));
  else
    origin.xy = (clip - offset.zw) / scale.xy;
  // Cleared depth is 1: there is no surface.
  float stops[LAMBENT_STOPS];
#if LAMBENT_STOPS == 1
  float depth = texelFetch(depth_picture, pixel, 0).r;
  stops[0] = depth < 1.0 ? viewZ(2.0 * depth - 1.0) / direction.z : kInfinity;
#else
  vec2 depths = depthsAt(pixel);
  for (int i = 0; i < 2; ++i) stops[i] = depths[i] < 1.0 ? viewZ(2.0 * depths[i] - 1.0) / direction.z : kInfinity;
#endif
  MarchRecord marched[LAMBENT_VOLUMES];
  VolumeRay rays[LAMBENT_VOLUMES];
  for (int v = 0; v < LAMBENT_VOLUMES; ++v) {
    marched[v] = records[v];
    rays[v] = enterVolume(marched[v], origin, direction, viewZ(-1.0) / direction.z);
  }
  vec4 gathered[LAMBENT_STOPS];
#ifdef LAMBENT_JITTER
  marchVolumes(marched, rays, stops, step_voxels, jitterOf(uvec2(pixel)), gathered);
#else
  marchVolumes(marched, rays, stops, step_voxels, 1.0, gathered);
#endif
#if LAMBENT_STOPS == 1
  if (gathered[0].a == 0.0) discard;  // leaves the pixel as it was, to the last bit
  color = vec4(gathered[0].rgb, lostOf(gathered[0].a));
#else
  const vec3 kLargest = vec3(65504.0);  // largest half float
  near = vec4(clamp(gathered[0].rgb, -kLargest, kLargest), exp(-gathered[0].a));
  far = vec4(clamp(gathered[1].rgb, -kLargest, kLargest), exp(-gathered[1].a));
#endif
}
#endif
