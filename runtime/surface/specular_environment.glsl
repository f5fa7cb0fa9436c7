// Adds the prefiltered environment (lighting/sky.hpp) as rough mirrors show it: on glossy surfaces what the
// few bands of light leave out of the sky, in the mirror of layered surfaces the sky as far as it is seen.
#include "prefiltered_shared.h"
layout(std140, binding = kBindReflection) uniform ReflectionBlock { ReflectionValues reflection; };
layout(binding = kUnitFirstReflection) uniform samplerCube first_reflection;
layout(binding = kUnitSecondReflection) uniform samplerCube second_reflection;
layout(binding = kUnitFirstWhole) uniform samplerCube first_whole;
layout(binding = kUnitSecondWhole) uniform samplerCube second_whole;

// Returns the mip level of a roughness, the inverse of roughnessOfLevel.
float levelOf(float roughness) { return reflection.shares.z * pow(roughness, 2.0 / 3.0); }

// Returns what a rough mirror shows of key lights in their true shape.
vec3 keyPicture(vec3 direction_ws, float roughness) {
  float level = levelOf(roughness);
  vec3 direction = mat3(reflection.light_from_world) * direction_ws;
  vec3 first = textureLod(first_whole, direction, level).rgb - textureLod(first_reflection, direction, level).rgb;
  vec3 second = textureLod(second_whole, direction, level).rgb - textureLod(second_reflection, direction, level).rgb;
  return max(reflection.shares.x * first + reflection.shares.y * second, vec3(0.0));
}

// Returns the highlights of key lights. They are those of discs, but a mirror that is sharp enough to show the true
// shape of the lights shows that.
vec3 keyHighlights(Lobes lobes, SurfaceLight light, vec3 mirrored_ws, vec3 rho) {
  const float kSharp = 0.05, kRough = 0.12;  // alpha
  float alpha = lobes.roughness * lobes.roughness;
  float pictured = lobes.anisotropy != 0.0 ? 0.0 : reflection.shares.w * (1.0 - smoothstep(kSharp, kRough, alpha));
  if (pictured == 0.0) return light.key_highlights;
  float open = dot(light.open_key_highlights, vec3(1.0)), seen = dot(light.key_highlights, vec3(1.0));
  float visible = open > 0.0 ? clamp(seen / open, 0.0, 1.0) : 1.0;
  return mix(light.key_highlights, visible * rho * keyPicture(mirrored_ws, lobes.roughness), pictured);
}

// Returns what a rough mirror shows of the sky without key lights.
vec3 reflectedSky(vec3 direction_ws, float roughness) {
  vec3 direction = mat3(reflection.light_from_world) * direction_ws;
  return reflection.shares.x * textureLod(first_reflection, direction, levelOf(roughness)).rgb +
         reflection.shares.y * textureLod(second_reflection, direction, levelOf(roughness)).rgb;
}

#ifdef LAMBENT_LAYERED
vec3 towardsWorld(vec3 direction) { return direction * mat3(draws[draw_of].glossy.group_from_world); }

// Returns the mean radiance of what hides the sky: E/pi without what the sky sends, over the share that is hidden. The
// sky is taken to be as it is about the mean direction in which it is seen, so at least a tenth is kept.
vec3 hiddenRadiance(vec3 received, float seen[kSeenCoefficients]) {
  const float kLeastKept = 0.1, kLeastHidden = 0.05;
  float open = seenShareOfAll(seen);
  vec3 sky = reflectedSky(towardsWorld(unit(vec3(seen[3], seen[1], seen[2]))), 1.0);
  return max(received - open * sky, kLeastKept * received) / max(1.0 - open, kLeastHidden);
}

// Shows the environment as far as it is seen about the mirrored direction, and elsewhere what hides it. Key lights are
// shown in their true shape.
void addLayeredEnvironment(Mirror mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  float seen[kSeenCoefficients];
  gatherSeen(mirror.position_mesh, seen);
  vec3 direction = reflect(-pixel_to_eye, pixel_normal), direction_ws = towardsWorld(direction);
  mirrored = mix(hiddenRadiance(mirrored, seen), reflectedSky(direction_ws, pixel_lobes.roughness),
                 seenAbout(direction, mirror.smooth_normal, seen));
  if (light.keys_apart) highlights = keyHighlights(pixel_lobes, light, direction_ws, mirror.albedo);
}
#else
// Returns what a rough mirror shows of the sky beyond the bands that the surface has of it: P(L) - P(L_n), which may
// be negative. The factors of the bands are interpolated like the mip levels, so that light of few bands leaves
// nothing.
vec3 residualLight(vec3 direction_ws, float roughness) {
  float level = levelOf(roughness);
  vec3 seen = reflectedSky(direction_ws, roughness);
  vec4 light[kCoefficients], bands[kBands];
  for (int k = 0; k < kCoefficients; ++k) light[k] = k < kUsedCoefficients ? reflection.light[k] : vec4(0.0);
  bandsAt(direction_ws, light, bands);
  int low = int(min(level, reflection.shares.z - 1.0));
  float share = level - float(low);
  vec4 first = mix(reflection.bands[2 * low], reflection.bands[2 * low + 2], share);
  vec4 second = mix(reflection.bands[2 * low + 1], reflection.bands[2 * low + 3], share);
  vec3 known = first.x * bands[0].rgb + first.y * bands[1].rgb + first.z * bands[2].rgb + first.w * bands[3].rgb;
#if LAMBENT_BANDS > 4
  known += second.x * bands[4].rgb;
#endif
#if LAMBENT_BANDS > 5
  known += second.y * bands[5].rgb;
#endif
  return seen - known;
}

// Averages residualLight() over the fan that brushed metal reflects. The fan consists of round lobes with the narrow
// roughness, about the view mirrored in normals that lean along the tangent. They have equal shares of GGX's slopes,
// whose marginal is s = a u / sqrt(1 - u^2) with u uniform in -1..1.
vec3 residualOver(Lobes lobes, vec3 normal, vec3 to_eye) {
  const int kShares = 12;
  float narrow = lobes.roughness * lobes.roughness, wide = mix(narrow, 1.0, lobes.anisotropy * lobes.anisotropy);
  float fan = sqrt(max(wide * wide - narrow * narrow, 0.0));
  // A vector times this matrix is the transpose times the vector, which takes it to the world.
  mat3 group_from_world = mat3(draws[draw_of].glossy.group_from_world);
  if (fan < 0.05) return residualLight(reflect(-to_eye, normal) * group_from_world, lobes.roughness);
  float between = fan / float(kShares);  // half the distance of two shares, wide enough to leave no gaps
  float roughness = sqrt(sqrt(narrow * narrow + between * between));
  vec3 sum = vec3(0.0);
  float weights = 0.0;
  for (int i = 0; i < kShares; ++i) {
    float u = (2.0 * float(i) + 1.0) / float(kShares) - 1.0;
    vec3 leaning = normalize(normal + fan * u * inversesqrt(1.0 - u * u) * lobes.tangent);
    vec3 mirrored = reflect(-to_eye, leaning);
    float weight = max(dot(leaning, to_eye), 0.0) * step(0.0, dot(mirrored, normal));
    if (weight <= 0.0) continue;
    sum += weight * residualLight(mirrored * group_from_world, roughness);
    weights += weight;
  }
  return weights > 0.0 ? sum / weights : vec3(0.0);
}

// Adds what the mirror shows of the sky beyond the bands. It is scaled by the share of the sky that the lobe sees, as far
// as few bands can tell: (c . V) / (c . 1). Key lights are shown in their true shape.
void addSpecularEnvironment(Reflected reflected, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  Fresnel fresnel = pixel_lobes.fresnel;
  vec3 rho = fresnel.f0 * reflected.albedo.x + fresnel.f90 * reflected.albedo.y;
  float f0 = dot(fresnel.f0, vec3(1.0 / 3.0));
  float seen = f0 * reflected.f0_light.w + fresnel.f90 * reflected.f90_light.w;
  float open = f0 * reflected.albedo.x + fresnel.f90 * reflected.albedo.y;
  float visibility = clamp(seen / max(open, 1e-6), 0.0, 1.0);
  mirrored += visibility * rho * residualOver(pixel_lobes, pixel_normal, pixel_to_eye);
  if (!light.keys_apart) return;
  vec3 mirrored_ws = reflect(-pixel_to_eye, pixel_normal) * mat3(draws[draw_of].glossy.group_from_world);
  highlights = keyHighlights(pixel_lobes, light, mirrored_ws, rho);
}
#endif
