// Gives the surface pass the grids of bodies nearby, which are looked up at the pixel's place.
#include "neighborhood_eval.glsl"

layout(std430, binding = kBindReceivers) readonly buffer Receivers { Receiver receivers[]; };
layout(std430, binding = kBindArrivals) readonly buffer Arrivals { Arrival arrivals[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;

vec4 atlasAt(vec3 texel) { return textureLod(atlas, texel / vec3(textureSize(atlas, 0)), 0.0); }

#if defined(LAMBENT_GLOSSY) && !defined(LAMBENT_LAYERED)
// Adds what bodies nearby change in the light of a glossy pixel, in the bands that both the grid and the surface
// have, reflected by the kernel for this view.
void addReflectedNeighborhoods(SurfacePoint at, inout SurfaceLight light) {
  for (uint a = receivers[at.draw].first; a < receivers[at.draw].first + receivers[at.draw].count; ++a) {
    vec3 place = vec4(at.position, 1.0) * arrivals[a].grid_from_position;
    float share = gridShare(place, arrivals[a].grid);
    if (share == 0.0) continue;
    vec4 change[kCoefficients];
    for (int k = 0; k < kCoefficients; ++k)
      change[k] = k < kUsedCoefficients && uint(k) < arrivals[a].grid.outputs ? share * gridOutput(place, arrivals[a].grid, uint(k)) : vec4(0.0);
    LocalView turned_view = pixel_view;
    turned_view.tangent = vec4(pixel_view.tangent, 0.0) * arrivals[a].body_from_group;
    turned_view.bitangent = vec4(pixel_view.bitangent, 0.0) * arrivals[a].body_from_group;
    turned_view.normal = vec4(pixel_view.normal, 0.0) * arrivals[a].body_from_group;
    pixel_change = sumOf(pixel_change, reflectLight(turned_view, pixel_weights, change));
  }
}
#else
// Adds what bodies nearby change in the light of a diffuse pixel, as E/pi. Each grid is looked up with the pixel's
// normal turned into the body's frame, so that no coefficients need to be rotated.
void addNeighborhoods(SurfacePoint at, inout SurfaceLight light) {
  for (uint a = receivers[at.draw].first; a < receivers[at.draw].first + receivers[at.draw].count; ++a) {
    vec3 place = vec4(at.position, 1.0) * arrivals[a].grid_from_position;
    float share = gridShare(place, arrivals[a].grid);
    if (share <= 0.0) continue;
    vec3 change = share * gridIrradiance(place, arrivals[a].grid, vec4(at.normal, 0.0) * arrivals[a].body_from_group);
    if (arrivals[a].whole != 0u)
      light.change_of_all += change;
    else
      light.change += change;
  }
}
#endif
