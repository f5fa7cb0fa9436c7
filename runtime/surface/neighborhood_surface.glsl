// Adds what bodies nearby change in the light of a diffuse pixel, as E/pi. Each grid is looked up with the pixel's
// normal turned into the body's frame, so that no coefficients need to be rotated.
#include "neighborhood_arrivals.glsl"

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
