// Adds what bodies nearby change at the vertices of draws with transfer of their own (neighborhood_vertices.comp).
#include "neighborhood_shared.h"
#include "with_change.glsl"
layout(std430, binding = kBindReceivers) readonly buffer Receivers { Receiver receivers[]; };
layout(std430, binding = kBindRadianceChange) readonly buffer RadianceChange { float change_of[]; };

void addVertexChange(uint vertex, inout vec3 radiance) {
  uint at = receivers[draw_index].change_word + 3u * vertex;
  radiance = withChange(radiance, vec3(change_of[at], change_of[at + 1u], change_of[at + 2u]));
}
