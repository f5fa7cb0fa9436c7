// Does the same as sh::cubeFaceDirection: returns the unnormalised direction to a place on a face of a cube,
// -1..1 along each edge.
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

// Returns that through a texel's centre in a cube map level with `size` texels per edge.
vec3 cubeTexelDirection(ivec3 texel, int size) {
  return cubeFaceDirection(texel.z, (2.0 * vec2(texel.xy) + 1.0) / float(size) - 1.0);
}
