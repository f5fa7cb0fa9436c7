// Receives light on glossy surfaces: those with a GGX or anisotropic GGX lobe have two lobes of the table, which F0 and
// F90 multiply, over a diffuse base; those with a measured BRDF have three, red, green and blue. l' is gathered at the
// pixel from the samples of the triangle's corners. It is not passed as varyings, because OpenGL 4.5 promises too few.
#include "mapped_normal.glsl"
#include "surface_light.glsl"
#include "shadowed_light.glsl"

layout(std430, binding = kBindRows) readonly buffer Rows { uint row_words[]; };
layout(std430, binding = kBindSamples) readonly buffer Samples { vec4 samples[]; };
layout(location = 6) in vec3 position_mesh;
layout(location = 7) in vec4 looks_at_reflection;
layout(location = 8) in vec4 looks_at_lobes;

#include "reflection_inputs.glsl"

// The number of bands that count. Higher ones are treated as 0.
#ifndef LAMBENT_USED_BANDS
#define LAMBENT_USED_BANDS LAMBENT_BANDS
#endif
const int kUsedCoefficients = LAMBENT_USED_BANDS * LAMBENT_USED_BANDS;

const bool kHighlights = true;

#include "vertex_rows.glsl"
uint rowWordAt(uint word) { return row_words[word]; }

#include "gathered_light.glsl"

// Gathers l' from the triangle's corners. A corner without samples leaves the pixel to the other corners.
void gatherLight(out vec4 light[kCoefficients]) {
  uvec3 corners = triangleCorners();
  vec3 weights = weightsOf(corners, position_mesh);
  VertexRows rows = VertexRows(draws[draw_of].glossy.rows_word, draws[draw_of].glossy.vertex_count, draws[draw_of].glossy.row_entries);
  float total = 0.0;
  for (int k = 0; k < kCoefficients; ++k) light[k] = vec4(0.0);
  for (int corner = 0; corner < 3; ++corner) {
    uvec2 row = rowOf(rows, corners[corner]);
    for (uint i = row.x; i < row.y; ++i) {
      RowEntry entry = rowEntryAt(rows, i);
      float weight = weights[corner] * entry.weight;
      uint at = draws[draw_of].glossy.first_output + uint(kCoefficients) * (entry.sample_index - draws[draw_of].glossy.first_sample);
      total += weight;
      for (int k = 0; k < kUsedCoefficients; ++k) light[k] += weight * samples[at + uint(k)];
    }
  }
  float scale = total > 0.0 ? 1.0 / total : 0.0;
  for (int k = 0; k < kCoefficients; ++k) light[k] *= scale;
  addGatheredLight(corners, weights, light);
}

#ifdef LAMBENT_MEASURED
Reflected pixel_change = Reflected(vec4(0.0), vec3(0.0), vec4(0.0));  // what bodies nearby change

Reflected sumOf(Reflected a, Reflected b) { return Reflected(a.light + b.light, a.albedo, a.diffuse + b.diffuse); }

#include "harmonic_steps.glsl"

// Evaluates the harmonics in direction d, which are the coefficients of a point of light there.
void pointLight(vec3 d, out vec4 light[kCoefficients]) {
  float c = 1.0, s = 0.0, sectoral = kConstantHarmonic;
  for (int m = 0; m < kBands; ++m) {
    if (m > 0) stepOrder(d, m, c, s, sectoral);
    float p = sectoral, before = 0.0;
    for (int l = m; l < kBands; ++l) {
      if (l > m) stepBand(d.z, l, m, p, before);
      light[l * (l + 1) + m] = vec4(p * c);
      if (m > 0) light[l * (l + 1) - m] = vec4(p * s);
    }
  }
}

// Returns pi f towards a light, in the bands that the table has. `spread` is ignored.
vec3 lightReflectance(vec3 to_light, float spread) {
  vec4 light[kCoefficients];
  pointLight(to_light, light);
  return 3.14159265 * max(reflectLight(pixel_view, pixel_weights, light).light.rgb, vec3(0.0)) /
         max(dot(pixel_view.normal, to_light), 0.05);
}
#else
#include "ggx_lobes.glsl"

Reflected pixel_change = Reflected(vec4(0.0), vec4(0.0), vec2(0.0), vec4(0.0));  // what bodies nearby change

Reflected sumOf(Reflected a, Reflected b) {
  return Reflected(a.f0_light + b.f0_light, a.f90_light + b.f90_light, a.albedo, a.diffuse + b.diffuse);
}
#endif

#include "received_light.glsl"

#ifdef LAMBENT_MEASURED
vec3 reflectedLight(vec3 base_color) {
  TangentFrame frame = pixelFrame();
  vec3 normal = pixelNormal(frame);
  vec4 light_of_bands[kCoefficients];
  gatherLight(light_of_bands);
  lookFrom(normal, vec3(0.0), towardsEye(position_mesh), 0.0, 0.0, uvec2(1u));
  Reflected reflected = reflectLight(pixel_view, pixel_weights, light_of_bands);

  SurfaceLight light = kNoLight;
  receiveLight(SurfacePoint(draws[draw_of].glossy.draw, position_mesh, draws[draw_of].facing * frame.normal, normal, kStraightUnknown), light);
  // Lights among the surfaces shine as on a diffuse surface that reflects as much of uniform light towards the eye.
  if (kShown == kShownIrradiance)
    return withChange(reflected.diffuse.rgb, pixel_change.diffuse.rgb) + light.key_highlights + light.local;
  return withChange(reflected.light.rgb, pixel_change.light.rgb) + light.key_highlights + reflected.albedo * light.local;
}
#else
#include "mirrored_sky.glsl"

vec3 reflectedLight(vec3 base_color) {
  TangentFrame frame = pixelFrame();
  pixel_normal = pixelNormal(frame);
  pixel_to_eye = towardsEye(position_mesh);
  vec4 light_of_bands[kCoefficients];
  gatherLight(light_of_bands);
  pixel_lobes = lobesAt(base_color, frame, pixel_normal);
  lookFrom(pixel_normal, pixel_lobes.tangent, pixel_to_eye, pixel_lobes.roughness, pixel_lobes.anisotropy,
           uvec2(draws[draw_of].glossy.roughnesses, draws[draw_of].glossy.strengths));
  Reflected reflected = reflectLight(pixel_view, pixel_weights, light_of_bands);
  Fresnel fresnel = pixel_lobes.fresnel;
  vec3 diffuse = diffuseAlbedo(base_color, pixel_lobes.metallic, fresnel, reflected.albedo);

  SurfaceLight light = kNoLight;
  receiveLight(SurfacePoint(draws[draw_of].glossy.draw, position_mesh, draws[draw_of].facing * frame.normal, pixel_normal, kStraightUnknown), light);
  vec3 received = withChange(reflected.diffuse.rgb, pixel_change.diffuse.rgb) + light.key + light.local;
  vec3 mirrored = withChange(fresnel.f0 * reflected.f0_light.rgb + fresnel.f90 * reflected.f90_light.rgb,
                             fresnel.f0 * pixel_change.f0_light.rgb + fresnel.f90 * pixel_change.f90_light.rgb);
  if (kShown == kShownIrradiance) return received;
  reflected.f0_light.w += pixel_change.f0_light.w;
  reflected.f90_light.w += pixel_change.f90_light.w;
  vec3 highlights = light.key_highlights;
  addMirroredSky(reflected, light, mirrored, highlights);
  return mirrored + diffuse * received + light.local_highlights + highlights;
}
#endif
