// Stage d computes the radiance that a proxy's triangle sends out, with one invocation per triangle of the proxies
// whose group was shaded anew.
#include "diffuse_shared.h"

layout(local_size_x = kWorkGroupSize) in;
layout(std430, binding = kBindWork) readonly buffer Work { uint work_count; uint pad[3]; WorkItem work[]; };
layout(std430, binding = kBindLights) readonly buffer Lights { vec4 lights[]; };
layout(std430, binding = kBindProxyGroups) readonly buffer Groups { ProxyGroupRecord groups[]; };
layout(std430, binding = kBindProxyTriangles) readonly buffer Triangles { ProxyTriangleRecord triangles[]; };
layout(std430, binding = kBindProxyEntries) readonly buffer Entries { ProxyEntryRecord entries[]; };
layout(std430, binding = kBindProxyRadiance) writeonly buffer Radiance { vec4 radiance[]; };
layout(std430, binding = kBindProxyAdded) readonly buffer Added { vec4 added[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };

#define LAMBENT_STAGE_PROXIES
#include "diffuse_eval.glsl"

vec3 lightAt(uint index) { return lights[index].rgb; }
vec4 sampleAt(uint index) { return samples[index]; }
ProxyEntryRecord proxyEntryAt(uint index) { return entries[index]; }

void main() {
  uint index = gl_WorkGroupID.x + gl_WorkGroupID.y * kMaxWorkGroupsX;
  if (index >= work_count) return;
  ProxyGroupRecord group = groups[work[index].record];
  uint place = work[index].first + gl_LocalInvocationID.x;
  if (place >= group.triangle_count) return;
  uint triangle = group.first_triangle + place;
  radiance[triangle] = vec4(proxyRadiance(group, triangles[triangle]) + added[triangle].rgb, 0.0);
}
