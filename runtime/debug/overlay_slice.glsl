// Draws a plane through the grid of a neighborhood, which shows how the body changes the light there: E/pi at a
// normal, or without one the mean radiance, both as luminance relative to the light without the body. The plane
// is transparent where little changes.
#include "surface_shared.h"
#include "overlay_slice_shared.h"

layout(std430, binding = kBindSlices) readonly buffer Slices { SliceRecord slices[]; };

#ifdef LAMBENT_VERTEX
layout(std140, binding = kBindView) uniform ViewBlock {
  mat4 view_from_world;
  mat4 clip_from_view;
  vec4 eye;
};
layout(location = 0) out vec3 place;  // in units of grid points
layout(location = 1) flat out int slice;

void main() {
  const vec2 kCorners[6] = vec2[6](vec2(0, 0), vec2(1, 0), vec2(0, 1), vec2(0, 1), vec2(1, 0), vec2(1, 1));
  slice = gl_InstanceID;
  int axis = int(slices[slice].axis);
  vec2 corner = kCorners[gl_VertexID];
  vec3 share = vec3(0.0);
  share[axis] = slices[slice].position;
  share[(axis + 1) % 3] = corner.x;
  share[(axis + 2) % 3] = corner.y;
  place = share * (vec3(slices[slice].grid.size_x, slices[slice].grid.size_y, slices[slice].grid.size_z) - 1.0);
  gl_Position = clip_from_view * (view_from_world * (slices[slice].world_from_place * vec4(place, 1.0)));
}
#else
#include "overlay_colors.glsl"
#include "neighborhood_eval.glsl"
#include "diffuse_light.glsl"

layout(std430, binding = kBindSliceLights) readonly buffer Lights { vec4 lights[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;
layout(location = 0) in vec3 place;
layout(location = 1) flat in int slice;
layout(location = 0) out vec4 color;

vec4 atlasAt(vec3 texel) { return textureLod(atlas, texel / vec3(textureSize(atlas, 0)), 0.0); }

float luminanceOf(vec3 c) { return dot(c, vec3(0.2126, 0.7152, 0.0722)); }

void main() {
  GridPlace grid = slices[slice].grid;
  vec3 normal = slices[slice].normal.xyz;
  vec3 open[9];
  for (uint j = 0u; j < 9u; ++j) open[j] = j < slices[slice].coefficients ? lights[slices[slice].light + j].rgb : vec3(0.0);
  float change, whole;
  if (normal == vec3(0.0)) {
    change = luminanceOf(gridOutput(place, grid, 0u).rgb);
    whole = luminanceOf(open[0]);
  } else {
    change = luminanceOf(gridIrradiance(place, grid, normal));
    whole = luminanceOf(diffuseLight(open, normal));
  }
  float relative = gridShare(place, grid) * change / max(whole, 1e-6);
  float alpha = mix(0.05, 0.92, smoothstep(0.0, 0.25, abs(relative)));
  color = vec4(alpha * shownColor(coolWarm(relative / kSliceRange)), alpha);
}
#endif
