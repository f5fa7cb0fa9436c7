// Shows the prefiltered environment in the mirror of a layered surface, as far as it is seen about the mirrored
// direction, and elsewhere what hides it. Key lights are shown in their true shape.
#include "reflected_sky.glsl"

vec3 towardsWorld(vec3 direction) { return direction * mat3(draws[draw_of].glossy.group_from_world); }

// Returns the mean radiance of what hides the sky: E/pi without what the sky sends, over the share that is hidden. The
// sky is taken to be as it is about the mean direction in which it is seen, so at least a tenth is kept.
vec3 hiddenRadiance(vec3 received, float seen[kSeenCoefficients]) {
  const float kLeastKept = 0.1, kLeastHidden = 0.05;
  float open = seenShareOfAll(seen);
  vec3 sky = reflectedSky(towardsWorld(unit(vec3(seen[3], seen[1], seen[2]))), 1.0);
  return max(received - open * sky, kLeastKept * received) / max(1.0 - open, kLeastHidden);
}

void addLayeredEnvironment(Mirror mirror, SurfaceLight light, inout vec3 mirrored, inout vec3 highlights) {
  float seen[kSeenCoefficients];
  gatherSeen(mirror.position_mesh, seen);
  vec3 direction = reflect(-pixel_to_eye, pixel_normal), direction_ws = towardsWorld(direction);
  mirrored = mix(hiddenRadiance(mirrored, seen), reflectedSky(direction_ws, pixel_lobes.roughness),
                 seenAbout(direction, mirror.smooth_normal, seen));
  if (light.keys_apart) highlights = keyHighlights(pixel_lobes, light, direction_ws, mirror.albedo);
}
