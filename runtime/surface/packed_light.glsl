// Unpacks the light of bands 0..2 of surfaces with a normal map, which comes as seven vectors of four numbers: nine of
// three would take two locations more than OpenGL 4.5 has for layered surfaces.
layout(location = 6) in vec4 packed_light[7];

vec3[kLightCoefficients] lightOfBands() {
  vec3 light[kLightCoefficients];
  for (int i = 0; i < 27; ++i) light[i / 3][i % 3] = packed_light[i / 4][i % 4];
  return light;
}
