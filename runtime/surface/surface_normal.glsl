// Applies normal maps: computes the normal at a pixel, in the group's frame.

// Describes the frame of a normal map, right-handed if `handedness` is +1. A tangent of 0 means that the surface has
// none; its normal then stays as it is.
struct TangentFrame {
  vec3 normal, tangent;
  float handedness;  // bitangent = handedness * cross(normal, tangent)
};

// Squared lengths below this count as 0, because their inverse root may not be finite.
const float kNoLength = 1e-36;

// Returns the direction at unit length. 0 stays 0, as for normals of flattened meshes.
vec3 unit(vec3 direction) { return direction * inversesqrt(max(dot(direction, direction), kNoLength)); }

// Returns the direction's part along the surface, at unit length.
vec3 alongSurface(vec3 normal, vec3 direction) {
  vec3 part = direction - dot(direction, normal) * normal;
  float squared = dot(part, part);
  return squared > kNoLength ? part * inversesqrt(squared) : vec3(0.0);
}

// Makes the frame from the mesh's own tangent.
TangentFrame frameFromTangent(vec3 normal, vec4 tangent) {
  return TangentFrame(normal, alongSurface(normal, tangent.xyz), tangent.w < 0.0 ? -1.0 : 1.0);
}

// Makes the frame from the derivatives of position p and texture coordinates t in the picture. The tangent points to
// rising u and the bitangent to falling v, because texture coordinates run downwards and a normal map's y upwards.
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
