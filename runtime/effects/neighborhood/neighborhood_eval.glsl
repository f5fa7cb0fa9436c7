// Light that a body takes from its surroundings or adds to them, looked up at a place: the math only, no bindings.
// neighborhood_ref.hpp is the same on the CPU, term by term. Places are in points of the grid: 0 the first, size - 1 the
// last, each way.
#include "neighborhood_shared.h"

// Of the atlas, between its texels; `texel` counts from the corner, so that texel i has its middle at i + 0.5.
vec4 atlasAt(vec3 texel);

// How much of the change counts: all but in the last cell towards each face, there smoothly less, at the faces and
// beyond them nothing. In a grid of two points it rises to its middle.
float gridShare(vec3 place, GridPlace grid) {
  vec3 last = vec3(grid.size_x, grid.size_y, grid.size_z) - 1.0;
  vec3 t = clamp(min(place, last - place) / min(vec3(1.0), 0.5 * last), 0.0, 1.0);
  vec3 rise = t * t * (3.0 - 2.0 * t);
  return rise.x * rise.y * rise.z;
}

// One output: RGB light, w visibility. Never mixed with those above and below it in the atlas.
vec4 gridOutput(vec3 place, GridPlace grid, uint slab) {
  vec3 last = vec3(grid.size_x, grid.size_y, grid.size_z) - 1.0;
  vec3 first = vec3(0.0, float(grid.first_y + grid.size_y * (slab / grid.slabs_per_column)),
                    float(grid.first_z + grid.size_z * (slab % grid.slabs_per_column)));
  return vec4(vec3(grid.scale), 1.0) * atlasAt(first + clamp(place, vec3(0.0), last) + 0.5);
}

// E/pi of the change at a normal in the body's frame: sum over i < 9 of A_l/pi y_i(n) times output i, as in
// diffuse_light.glsl, of which it is the form that looks up as it goes.
vec3 gridIrradiance(vec3 place, GridPlace grid, vec3 n) {
  vec3 sum = 0.28209479 * gridOutput(place, grid, 0u).rgb;
  sum += 0.32573501 * (n.y * gridOutput(place, grid, 1u).rgb + n.z * gridOutput(place, grid, 2u).rgb +
                       n.x * gridOutput(place, grid, 3u).rgb);
  sum += 0.27313711 * (n.x * n.y * gridOutput(place, grid, 4u).rgb + n.y * n.z * gridOutput(place, grid, 5u).rgb +
                       n.x * n.z * gridOutput(place, grid, 7u).rgb);
  sum += 0.07884789 * (3.0 * n.z * n.z - 1.0) * gridOutput(place, grid, 6u).rgb;
  sum += 0.13656855 * (n.x * n.x - n.y * n.y) * gridOutput(place, grid, 8u).rgb;
  return sum;
}

#include "with_change.glsl"
