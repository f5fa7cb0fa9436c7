// Gives the surface pass the grids of bodies nearby, which are looked up at the pixel's place.
#include "neighborhood_eval.glsl"

layout(std430, binding = kBindReceivers) readonly buffer Receivers { Receiver receivers[]; };
layout(std430, binding = kBindArrivals) readonly buffer Arrivals { Arrival arrivals[]; };
layout(binding = kUnitAtlas) uniform sampler3D atlas;

vec4 atlasAt(vec3 texel) { return textureLod(atlas, texel / vec3(textureSize(atlas, 0)), 0.0); }
