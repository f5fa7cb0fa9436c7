// Declares what every fragment shader of surfaces has: the draw, its vertices' outputs, and texture lookups. If
// surface_kind.glsl, which Surfaces writes, sets kFinestTexels, textures are read as one ray through the pixel's
// centre sees them.
#include "surface_shared.h"
#include "surface_kind.glsl"

layout(std430, binding = kBindDraws) readonly buffer Draws { SurfaceDraw draws[]; };
layout(location = 0) flat in uint draw_of;
layout(location = 1) in vec4 looks_at;      // texture coordinates; xy: base colour, zw: emission
layout(location = 2) in vec4 vertex_color;

vec4 look(sampler2D image, vec2 at) { return kFinestTexels ? textureLod(image, at, 0.0) : texture(image, at); }
