// Divides light from infinity into key lights, which a few SH bands cannot carry (suns, and in environment
// maps also lamps, windows and soft boxes), and the rest, which they can. It takes lights in their own frame
// and returns the keys as uniform discs, and the lights without them; keys and rest add up to all light, per
// channel. The loss (light_pieces.hpp) decides whether there are keys and how many. Turning, fading and
// dimming the lights later turns, fades and dims the keys but never changes which there are. Pure CPU, safe
// to call from any thread. A large picture takes a fraction of a second, and no longer than one read of it if
// there are no keys.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::lighting {

struct KeyLightOptions {
  std::uint32_t most = 16;   // maximum number of key lights; 0: none are sought
  int order = 5;             // number of SH bands that carry the rest
  double least_loss = 0.01;  // the search stops when the rest loses less than this
  // Larger lights are divided into pieces of the first radius. If `most` such pieces (8 degrees) do not
  // suffice, pieces may be wider, up to the second radius. The limits are approximate: a key may be a tenth
  // larger.
  float largest_radius_rad = 0.14f, widest_radius_rad = 0.28f;
};

// States where a key light was found.
struct KeyOrigin {
  bool in_map = false;    // true: found in an environment map; false: a disc or a piece of one
  std::size_t index = 0;  // into lights.environment_maps (the one with most of it) or lights.discs
  bool piece = false;     // part of a disc that was divided
};

// Names a texel of lights.environment_maps that gave light to a key.
struct KeyTexel {
  std::uint32_t environment_map = 0, texel = 0, key = 0;
};

struct PartedLights {
  std::vector<spec::Disc> keys;    // ordered by falling loss
  std::vector<KeyOrigin> origins;  // in the order of `keys`
  std::vector<KeyTexel> texels;
  std::vector<spec::Disc> discs;  // discs in the rest, which also keeps the whole constant
  // Holds, for each of lights.environment_maps, the picture without its keys, or nothing if it is unchanged.
  std::vector<std::optional<spec::EnvironmentMap>> environment_maps;
  // The loss of all light at options.order, and the loss that remains: that of the rest together with the
  // error of representing keys as round discs.
  double loss_before = 0.0, loss_after = 0.0;
  // The rest keeps this luminance where a key was taken out of a picture; 0 if none was.
  float threshold = 0.0f;
};

PartedLights partLights(const spec::DistantLights& lights, const KeyLightOptions& options = {});

}  // namespace lambent::lighting
