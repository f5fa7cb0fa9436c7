// Shows the room in a sharp metal, where a reflection probe knows what the mirrored ray meets, in place of the few bands
// of transferred light and of what they leave out of the sky. Rough metals keep their bands, which know the room better.
#include "reflection_probes.glsl"

void addGlossyProbes(Reflected reflected, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  const float kSharp = 0.35, kRough = 0.6;  // roughness
  float share = 1.0 - smoothstep(kSharp, kRough, pixel_lobes.roughness);
  if (probes.counts.y == 0.0 || share == 0.0 || pixel_lobes.anisotropy != 0.0) return;
  vec3 place_ws = (draws[draw_of].world_from_mesh * vec4(position_mesh, 1.0)).xyz;
  vec3 normal = draws[draw_of].facing * unit(normal_group.xyz);
  vec4 room = probeMirror(place_ws, normal, mat3(draws[draw_of].glossy.group_from_world));
  Fresnel fresnel = pixel_lobes.fresnel;
  vec3 rho = fresnel.f0 * reflected.albedo.x + fresnel.f90 * reflected.albedo.y;
  mirrored = mix(mirrored, rho * room.rgb + (1.0 - room.a) * mirrored, share);
}
