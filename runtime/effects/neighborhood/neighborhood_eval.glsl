// Looks up the light that a body takes from its surroundings or adds to them. It holds the mathematics only and no
// bindings. Places are counted in points of the grid: 0 is the
// first and size - 1 the last along each axis.
#include "neighborhood_shared.h"

// Returns the atlas interpolated between texels. `texel` counts from the corner, so that texel i has its centre at i
// + 0.5.
vec4 atlasAt(vec3 texel);

// Returns how much of the change counts: 1 inside, falling smoothly in the last cell towards each face to 0 at the
// faces and beyond. In a grid of two points it rises up to the middle.
float gridShare(vec3 place, GridPlace grid) {
  vec3 last = vec3(grid.size_x, grid.size_y, grid.size_z) - 1.0;
  vec3 t = clamp(min(place, last - place) / min(vec3(1.0), 0.5 * last), 0.0, 1.0);
  vec3 rise = t * t * (3.0 - 2.0 * t);
  return rise.x * rise.y * rise.z;
}

// Returns one output: RGB light and, in w, visibility. It is never mixed with the outputs above and below it in the
// atlas.
vec4 gridOutput(vec3 place, GridPlace grid, uint slab) {
  vec3 last = vec3(grid.size_x, grid.size_y, grid.size_z) - 1.0;
  vec3 first = vec3(0.0, float(grid.first_y + grid.size_y * (slab / grid.slabs_per_column)),
                    float(grid.first_z + grid.size_z * (slab % grid.slabs_per_column)));
  return vec4(vec3(grid.scale), 1.0) * atlasAt(first + clamp(place, vec3(0.0), last) + 0.5);
}

// Returns E/pi of the change at a normal in the body's frame: the sum over i < 9 of A_l/pi y_i(n) times output i. It
// is diffuse_light.glsl's sum, but looks the outputs up as it goes.
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
