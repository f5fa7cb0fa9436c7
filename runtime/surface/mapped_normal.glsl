// Computes the normal of a pixel from a normal map, in the group's frame.
#include "surface_normal.glsl"

layout(binding = kUnitNormal) uniform sampler2D normal_texture;
layout(location = 3) in vec4 position_group;  // w, and normal_group.w: coordinates in the normal map
layout(location = 4) in vec4 normal_group;
layout(location = 5) in vec4 tangent_group;  // w: +1 or -1 as in glTF, for the mesh as placed in the group

// Returns the frame on the front side, from the vertices' tangents if the mesh has them, else from the derivatives of
// the texture coordinates.
TangentFrame pixelFrame() {
  vec2 at = vec2(position_group.w, normal_group.w);
  vec3 normal = unit(normal_group.xyz);
  TangentFrame from_picture =
      frameFromDerivatives(normal, dFdx(position_group.xyz), dFdy(position_group.xyz), dFdx(at), dFdy(at));
  bool stored = draws[draw_of].tangents_word != kAbsent;
  return stored ? frameFromTangent(normal, tangent_group) : from_picture;
}

// Returns the normal on the visible side.
vec3 pixelNormal(TangentFrame frame) {
  vec3 normal = frame.normal;
  if (draws[draw_of].normal_texture.set != kAbsent) {
    vec2 at = vec2(position_group.w, normal_group.w);
    normal = perturbedNormal(frame, look(normal_texture, at).xyz, draws[draw_of].normal_scale);
  }
  return draws[draw_of].facing * normal;
}

vec3 shadingNormal() { return pixelNormal(pixelFrame()); }
