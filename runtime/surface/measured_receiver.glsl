// Receives light on surfaces with a measured BRDF: three lobes of the table, red, green and blue.
#include "glossy_receiver.glsl"

// These hold values of the pixel that is being shaded, for modules.
LocalView pixel_view = LocalView(vec3(0.0), vec3(0.0), vec3(0.0), 0.0, vec2(0.0));
vec4 pixel_weights[kTexels];
Reflected pixel_change = Reflected(vec4(0.0), vec3(0.0), vec4(0.0));  // what bodies nearby change

// Sets the view of this pixel and its weights of the table. It stands above everything that reads them, because
// compilers warn of variables that are read in a function above the one that sets them.
void lookFrom(vec3 normal, vec3 tangent, vec3 to_eye, float roughness, float anisotropy, uvec2 nodes) {
  pixel_view = localView(normal, tangent, to_eye);
  lookUpWeights(pixel_view, roughness, anisotropy, nodes, pixel_weights);
}

Reflected sumOf(Reflected a, Reflected b) { return Reflected(a.light + b.light, a.albedo, a.diffuse + b.diffuse); }

// Evaluates the harmonics in direction d, which are the coefficients of a point of light there. The recurrences are
// Cartesian, as in diffuse_eval.glsl.
void pointLight(vec3 d, out vec4 light[kCoefficients]) {
  float c = 1.0, s = 0.0, sectoral = 0.28209479;
  for (int m = 0; m < kBands; ++m) {
    if (m > 0) {
      float next_c = d.x * c - d.y * s;
      s = d.x * s + d.y * c;
      c = next_c;
      sectoral *= m == 1 ? sqrt(3.0) : sqrt(float(2 * m + 1) / float(2 * m));
    }
    float p = sectoral, before = 0.0;
    for (int l = m; l < kBands; ++l) {
      if (l > m) {
        float factor = sqrt(float(4 * l * l - 1) / float(l * l - m * m));
        float back = l == m + 1 ? 0.0 : factor * sqrt(float((l - 1) * (l - 1) - m * m) / float(4 * (l - 1) * (l - 1) - 1));
        float next = factor * d.z * p - back * before;
        before = p;
        p = next;
      }
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

#include "received_light.glsl"

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
