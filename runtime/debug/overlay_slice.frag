// Shows how a body changes the light on the plane: E/pi at a normal, or without one the mean radiance, both
// as luminance relative to the light without the body. The plane is transparent where little changes.
#include "overlay_colors.glsl"
#include "neighborhood_eval.glsl"
#include "overlay_slice_shared.h"
#include "diffuse_light.glsl"

layout(std430, binding = kBindSlices) readonly buffer Slices { SliceRecord slices[]; };
layout(std430, binding = kBindSliceLights) readonly buffer Lights { vec4 lights[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;
layout(location = 1) uniform float strength;  // lower for hidden parts
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
  float alpha = strength * mix(0.05, 0.92, smoothstep(0.0, 0.25, abs(relative)));
  color = vec4(alpha * shownColor(coolWarm(relative / kSliceRange)), alpha);
}
