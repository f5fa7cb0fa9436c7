// Shows the room in the mirror of a layered surface, where a reflection probe knows what the mirrored ray meets, in place
// of the sky where it is seen and a mean elsewhere. Highlights of key lights stay what they are: probes see what key
// lights shine on, but not key lights.
#include "reflection_probes.glsl"

void addLayeredProbes(Mirror mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  if (probes.counts.y == 0.0) return;
  vec3 place_ws = (draws[draw_of].world_from_mesh * vec4(mirror.position_mesh, 1.0)).xyz;
  vec4 room = probeMirror(place_ws, mirror.smooth_normal, mat3(draws[draw_of].glossy.group_from_world));
  mirrored = room.rgb + (1.0 - room.a) * mirrored;
}
