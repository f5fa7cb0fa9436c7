// What every surface shader of the fragment stage has: the draw, what its vertices bring, and pictures. The kind of surface
// (surface_kind.glsl, which Surfaces writes) says whether pictures are read as one ray through the pixel's centre sees them.
#include "surface_shared.h"
#include "surface_kind.glsl"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(location = 0) flat in uint draw_of;
layout(location = 1) in vec4 looks_at;      // in the base colour picture: xy; in the emissive one: zw
layout(location = 2) in vec4 vertex_color;

vec4 look(sampler2D image, vec2 at) { return kFinestTexels ? textureLod(image, at, 0.0) : texture(image, at); }
