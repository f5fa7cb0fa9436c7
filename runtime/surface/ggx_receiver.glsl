// Receives light on glossy surfaces with a GGX or anisotropic GGX lobe: two lobes of the table, which F0 and F90
// multiply, over a diffuse base.
#include "glossy_receiver.glsl"
#include "ggx_lobes.glsl"

Reflected pixel_change = Reflected(vec4(0.0), vec4(0.0), vec2(0.0), vec4(0.0));  // what bodies nearby change

Reflected sumOf(Reflected a, Reflected b) {
  return Reflected(a.f0_light + b.f0_light, a.f90_light + b.f90_light, a.albedo, a.diffuse + b.diffuse);
}

#include "received_light.glsl"
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
