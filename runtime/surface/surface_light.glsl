// What light modules add to a surface at a pixel. Each module has a function that takes the point and adds to the light;
// Surfaces writes received_light.glsl, which calls those of a draw one after the other (runtime/draws/surface_module.hpp).
#include "with_change.glsl"

struct SurfacePoint {
  uint draw;           // place of the draw in the tables of the modules
  vec3 position;       // as neighborhoods take it: mesh space, or of normal-mapped surfaces the group's frame
  vec3 smooth_normal;  // the vertices', group frame, on the side that is seen
  vec3 normal;         // by which the surface is shaded; unit
};

struct SurfaceLight {
  vec3 change;         // what bodies around change in the light that transfer brings, E/pi
  vec3 change_of_all;  // the same, of light with key lights among it
  vec3 local;          // E/pi from lights among the surfaces
  vec3 key;            // E/pi from key lights
  vec3 open_key;       // the same as if nothing were in their way
  bool keys_apart;     // key lights shine here, so transfer has no light of theirs
  // Radiance towards the eye, of glossy surfaces alone.
  vec3 local_highlights, key_highlights, open_key_highlights;
};

const SurfaceLight kNoLight = SurfaceLight(vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), vec3(0.0), false, vec3(0.0), vec3(0.0), vec3(0.0));

// E/pi: what transfer brings, with all that was added to it. A volume takes the same share of the key lights that arrive
// here as it would of all of them.
vec3 withLight(vec3 received, SurfaceLight light) {
  if (!light.keys_apart) return withChange(received, light.change + light.change_of_all) + light.local;
  received = withChange(received, light.change) + light.local;
  return (received + light.key) * max(1.0 + light.change_of_all / max(received + light.open_key, vec3(1e-6)), vec3(0.0));
}
