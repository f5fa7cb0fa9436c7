// Declares the light that modules add to a surface at a pixel. Each module has a function that takes the point and
// adds to the light; Surfaces writes received_light.glsl, which calls those of a draw one after the other
// (runtime/draws/surface_module.hpp).
#include "with_change.glsl"

struct SurfacePoint {
  uint draw;           // index of the draw in the tables of the modules
  vec3 position;       // for neighborhoods: mesh space, or the group's frame if normal-mapped
  vec3 smooth_normal;  // interpolated from the vertices, group frame, visible side
  vec3 normal;         // unit vector by which the surface is shaded
  // Luminance of E/pi that transfer brings straight from lights that are shaded per pixel; kStraightUnknown if it is
  // not at hand.
  float straight;
};
const float kStraightUnknown = -1.0;

struct SurfaceLight {
  vec3 change;         // change by bodies nearby of the light that transfer brings, E/pi
  vec3 change_of_all;  // change of light that includes key lights, E/pi
  vec3 local;          // E/pi from lights among the surfaces
  vec3 key;            // E/pi from key lights
  vec3 open_key;       // the same without occlusion
  bool keys_apart;     // true: key lights shine here, so transfer does not contain them
  // These hold radiance towards the eye, for glossy surfaces only.
  vec3 local_highlights, key_highlights, open_key_highlights;
};

const SurfaceLight kNoLight = SurfaceLight(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), false, vec3(0.0), vec3(0.0), vec3(0.0));

// Returns E/pi: what transfer brings with everything that was added to it. A volume removes the same share of the key
// light that arrives here as it would of unoccluded key light.
vec3 withLight(vec3 received, SurfaceLight light) {
  if (!light.keys_apart) return withChange(received, light.change + light.change_of_all) + light.local;
  received = withChange(received, light.change) + light.local;
  return (received + light.key) * max(1.0 + light.change_of_all / max(received + light.open_key, vec3(1e-6)), vec3(0.0));
}
