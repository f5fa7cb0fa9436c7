// Returns the unnormalised direction through a texel's centre in a cube map level with `size` texels per
// edge, as runtime/sh/image_layout.hpp defines it.
vec3 cubeTexelDirection(ivec3 texel, int size) {
  vec2 at = (2.0 * vec2(texel.xy) + 1.0) / float(size) - 1.0;
  switch (texel.z) {
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
