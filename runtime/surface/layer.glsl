// Adds the specular layer of a smooth dielectric, which lies over diffuse transfer. The mirror shows the prefiltered
// environment, as far as the transfer knows that it can be seen, and something like the light around the surface where
// it is hidden. Highlights of key lights and of lights among the surfaces are those of glossy surfaces.
// Without LAMBENT_LAYERED there is no layer, and a surface has no highlights.
#include "shadowed_light.glsl"

#ifdef LAMBENT_LAYERED
const bool kHighlights = true;

#include "reflection_inputs.glsl"
#include "ggx_lobes.glsl"
#include "seen_sky.glsl"

layout(binding = kUnitSeenKernel) uniform sampler2DArray seen_kernel;
layout(std430, binding = kBindRadiance) readonly buffer Seen { uint seen_words[]; };

// Describes where a mirror looks, for the module that shows the sky in it.
struct Mirror {
  vec3 smooth_normal;  // of the surface that the transfer knows, on its visible side
  vec3 position_mesh;
  vec3 albedo;  // directional, of the layer
};

void lookAtLayer(vec3 base_color, TangentFrame frame, vec3 normal, vec3 position_mesh) {
  pixel_normal = normal;
  pixel_to_eye = towardsEye(position_mesh);
  pixel_lobes = lobesAt(base_color, frame, normal);
  // A table with azimuths is looked up at any, because it does not depend on them without anisotropy.
  lookFrom(normal, perpendicular(normal), pixel_to_eye, pixel_lobes.roughness, 0.0,
           uvec2(draws[draw_of].glossy.roughnesses, draws[draw_of].glossy.strengths));
}

// Interpolates what the corners see of the sky.
void gatherSeen(vec3 position_mesh, out float seen[kSeenCoefficients]) {
  uvec3 corners = triangleCorners();
  vec3 weights = weightsOf(corners, position_mesh);
  for (uint k = 0u; k < kSeenCoefficients; ++k) seen[k] = 0.0;
  for (int corner = 0; corner < 3; ++corner) {
    uint word = draws[draw_of].glossy.seen_word + kSeenWords * corners[corner];
    for (uint k = 0u; k < kSeenCoefficients; ++k) {
      vec2 pair = unpackHalf2x16(seen_words[word + k / 2u]);
      seen[k] += weights[corner] * pair[k % 2u];
    }
  }
}

// Returns the share of the sky that the mirror sees about a direction.
float seenAbout(vec3 direction, vec3 normal, float seen[kSeenCoefficients]) {
  const vec3 kAxes[kSeenBands] = LAMBENT_SEEN_AXES;
  LocalView view = localView(normal, perpendicular(normal), direction);
  vec2 nodes = vec2(textureSize(seen_kernel, 0).xy);
  vec2 place = (vec2(angleAxis(view.cos_theta), clamp(pixel_lobes.roughness, 0.0, 1.0)) * (nodes - 1.0) + 0.5) / nodes;
  float weights[kSeenWeights + 1u];
  for (uint i = 0u; i < (kSeenWeights + 1u) / 4u; ++i) {
    vec4 four = textureLod(seen_kernel, vec3(place, float(i)), 0.0);
    for (uint j = 0u; j < 4u; ++j) weights[4u * i + j] = four[j];
  }
  return seenShare(seen, weights, kAxes, mat3(view.tangent, view.bitangent, view.normal));
}
#else
const bool kHighlights = false;
vec3 lightReflectance(vec3 to_light, float spread) { return vec3(0.0); }
#endif

#include "received_light.glsl"

#ifdef LAMBENT_LAYERED
#include "mirrored_sky.glsl"

// Returns what the base and the layer reflect: `transferred` is E/pi without lights that are shaded per pixel.
vec3 throughLayer(vec3 base_color, Mirror mirror, vec3 transferred, SurfaceLight light) {
  vec3 received = withLight(transferred, light);
  if (kShown == kShownIrradiance) return received;
  Fresnel fresnel = pixel_lobes.fresnel;
  vec2 albedo = pixel_weights[0].xy;
  mirror.albedo = fresnel.f0 * albedo.x + fresnel.f90 * albedo.y;
  vec3 mirrored = max(withChange(transferred, light.change + light.change_of_all), vec3(0.0)), highlights = light.key_highlights;
  addMirroredSky(mirror, light, mirrored, highlights);
  return diffuseAlbedo(base_color, pixel_lobes.metallic, fresnel, albedo) * received + mirror.albedo * mirrored +
         highlights + light.local_highlights;
}
#endif
