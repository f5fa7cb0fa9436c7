// Composites the march over a picture with several samples per pixel. Each sample takes what was gathered up to the
// pixel's nearest or farthest sample, whichever is closer to it.
#include "volume_shared.h"

layout(binding = kUnitDepth) uniform sampler2DMS depth_picture;
layout(binding = kUnitMarched) uniform sampler2DArray marched;
layout(location = 0) uniform vec4 scale;  // as in volume_march.frag
layout(location = 3) uniform bool perspective;
layout(location = 0) out vec4 color;

float viewZ(float depth) { return perspective ? -scale.w / (depth + scale.z) : (depth - scale.w) / scale.z; }

void main() {
  ivec2 pixel = ivec2(gl_FragCoord.xy);
  float nearest = 1.0, farthest = 0.0;
  for (int i = 0; i < LAMBENT_SAMPLES; ++i) {
    float depth = texelFetch(depth_picture, pixel, i).r;
    nearest = min(nearest, depth);
    farthest = max(farthest, depth);
  }
  float own = viewZ(2.0 * texelFetch(depth_picture, pixel, gl_SampleID).r - 1.0);
  bool before = viewZ(2.0 * nearest - 1.0) - own <= own - viewZ(2.0 * farthest - 1.0);
  vec4 gathered = texelFetch(marched, ivec3(pixel, before ? 0 : 1), 0);
  if (gathered == vec4(0.0, 0.0, 0.0, 1.0)) discard;  // leaves the pixel as it was
  color = vec4(gathered.rgb, 1.0 - gathered.a);
}
