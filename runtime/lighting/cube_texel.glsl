// Returns the unnormalised direction through a place of a cube map's face, -1..1 along its edges, as
// runtime/sh/image_layout.hpp defines it.
vec3 cubeFaceDirection(int face, vec2 at) {
  switch (face) {
    case 0:
      return vec3(1.0, -at.y, -at.x);
    case 1:
      return vec3(-1.0, -at.y, at.x);
    case 2:
      return vec3(at.x, 1.0, at.y);
    case 3:
      return vec3(at.x, -1.0, -at.y);
    case 4:
      return vec3(at.x, -at.y, 1.0);
  }
  return vec3(-at.x, -at.y, -1.0);
}

// Returns the same through a texel's centre in a level with `size` texels per edge.
vec3 cubeTexelDirection(ivec3 texel, int size) {
  return cubeFaceDirection(texel.z, (2.0 * vec2(texel.xy) + 1.0) / float(size) - 1.0);
}

// Returns a frame about the unit vector n [Duff et al., Building an orthonormal basis, revisited, 2017].
mat3 frameAbout(vec3 n) {
  float facing = n.z >= 0.0 ? 1.0 : -1.0;
  float a = -1.0 / (facing + n.z), b = n.x * n.y * a;
  return mat3(vec3(1.0 + facing * n.x * n.x * a, facing * b, -facing * n.x), vec3(b, facing + n.y * n.y * a, -n.y), n);
}
