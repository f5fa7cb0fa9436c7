// Builds the pyramid over a shadow map: level 0 holds the least and greatest depth of kBlockerTexels² texels
// of the map, each further level those of 2 x 2 texels of the level below.
#include "key_shared.h"

layout(local_size_x = kBlockerGroup, local_size_y = kBlockerGroup) in;
layout(location = 0) uniform ivec2 first;   // first texel of the tile in the level that is written
layout(location = 1) uniform int size;      // edge of the tile in texels of that level
layout(location = 2) uniform int level;     // the level that is written
layout(binding = 0) uniform sampler2D depths;    // read for level 0
layout(binding = 1) uniform sampler2D blockers;  // read for the other levels
layout(binding = 0, rg32f) writeonly uniform image2D written;

void main() {
  ivec2 place = ivec2(gl_GlobalInvocationID.xy);
  if (place.x >= size || place.y >= size) return;
  ivec2 texel = first + place;
  vec2 bounds = vec2(1.0, 0.0);
  if (level == 0) {
    for (int y = 0; y < int(kBlockerTexels); ++y)
      for (int x = 0; x < int(kBlockerTexels); ++x) {
        float depth = texelFetch(depths, int(kBlockerTexels) * texel + ivec2(x, y), 0).r;
        bounds = vec2(min(bounds.x, depth), max(bounds.y, depth));
      }
  } else {
    for (int i = 0; i < 4; ++i) {
      vec2 below = texelFetch(blockers, 2 * texel + ivec2(i & 1, i >> 1), level - 1).rg;
      bounds = vec2(min(bounds.x, below.x), max(bounds.y, below.y));
    }
  }
  imageStore(written, texel, vec4(bounds, 0.0, 0.0));
}
