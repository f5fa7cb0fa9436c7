// The sky as all points see it: per texel of the cube in world axes the mean over subsamples² directions of the probes,
// plus the constants. Suns are not in it.
layout(local_size_x = 64) in;
layout(location = 0) uniform mat3 light_from_world;
layout(location = 1) uniform uint size;
layout(location = 2) uniform uint subsamples;
layout(location = 3) uniform vec2 levels;  // of the mip maps of both sets' probes: one texel to a subsample
layout(location = 4) uniform vec3 constant_radiance;
layout(location = 5) uniform vec2 shares;  // of the sets' probes
layout(binding = 0) uniform samplerCube first_probes;
layout(binding = 1) uniform samplerCube second_probes;
layout(std430, binding = 0) writeonly buffer Sky { vec4 sky[]; };

// sh::cubeFaceDirection
vec3 faceDirection(uint face, float sc, float tc) {
  switch (face) {
    case 0u: return vec3(1.0, -tc, -sc);
    case 1u: return vec3(-1.0, -tc, sc);
    case 2u: return vec3(sc, 1.0, tc);
    case 3u: return vec3(sc, -1.0, -tc);
    case 4u: return vec3(sc, -tc, 1.0);
    default: return vec3(-sc, -tc, -1.0);
  }
}

void main() {
  uint texel = gl_GlobalInvocationID.x;
  if (texel >= 6u * size * size) return;
  uint face = texel / (size * size), x = texel % size, y = texel / size % size;
  float step = 2.0 / float(size * subsamples);
  vec3 sum = vec3(0.0);
  for (uint j = 0u; j < subsamples; ++j)
    for (uint i = 0u; i < subsamples; ++i) {
      float sc = (float(x * subsamples + i) + 0.5) * step - 1.0;
      float tc = (float(y * subsamples + j) + 0.5) * step - 1.0;
      vec3 direction = light_from_world * faceDirection(face, sc, tc);
      if (shares.x > 0.0) sum += shares.x * textureLod(first_probes, direction, levels.x).rgb;
      if (shares.y > 0.0) sum += shares.y * textureLod(second_probes, direction, levels.y).rgb;
    }
  sky[texel] = vec4(sum / float(subsamples * subsamples) + constant_radiance, 0.0);
}
