// Normal maps: the normal at a pixel, in the group's frame. surface_normal_ref.hpp is the same on the CPU, term by term.

// Right-handed where `handedness` is +1. A tangent of 0: the surface has none, its normal stays as it is.
struct TangentFrame {
  vec3 normal, tangent;
  float handedness;  // of the bitangent, cross(normal, tangent) times this
};

// Below this a squared length is no length: its inverse root may not be finite.
const float kNoLength = 1e-36;

// At unit length; 0 stays 0, as normals of flattened meshes are.
vec3 unit(vec3 direction) { return direction * inversesqrt(max(dot(direction, direction), kNoLength)); }

// The direction's part along the surface, at unit length.
vec3 alongSurface(vec3 normal, vec3 direction) {
  vec3 part = direction - dot(direction, normal) * normal;
  float squared = dot(part, part);
  return squared > kNoLength ? part * inversesqrt(squared) : vec3(0.0);
}

// From the mesh's own tangent.
TangentFrame frameFromTangent(vec3 normal, vec4 tangent) {
  return TangentFrame(normal, alongSurface(normal, tangent.xyz), tangent.w < 0.0 ? -1.0 : 1.0);
}

// From how position p and texture coordinates t change over the picture. The tangent points to rising u; the
// bitangent to falling v, for texture coordinates run downwards and a normal map's y upwards.
TangentFrame frameFromDerivatives(vec3 normal, vec3 p_dx, vec3 p_dy, vec2 t_dx, vec2 t_dy) {
  float turn = sign(t_dx.x * t_dy.y - t_dy.x * t_dx.y);  // 0: the coordinates do not span the surface
  vec3 rising_u = turn * (t_dy.y * p_dx - t_dx.y * p_dy);
  vec3 rising_v = turn * (t_dx.x * p_dy - t_dy.x * p_dx);
  vec3 tangent = alongSurface(normal, rising_u);
  return TangentFrame(normal, tangent, dot(cross(normal, tangent), rising_v) > 0.0 ? -1.0 : 1.0);
}

vec3 perturbedNormal(TangentFrame frame, vec3 texel, float scale) {
  vec3 bump = (2.0 * texel - 1.0) * vec3(scale, scale, 1.0);
  if (frame.tangent == vec3(0.0) || dot(bump, bump) <= kNoLength) return frame.normal;
  vec3 bitangent = frame.handedness * cross(frame.normal, frame.tangent);
  return normalize(bump.x * frame.tangent + bump.y * bitangent + bump.z * frame.normal);
}
