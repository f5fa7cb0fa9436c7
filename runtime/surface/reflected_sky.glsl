// Looks up the prefiltered environment (lighting/sky.hpp) as rough mirrors show it.
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
