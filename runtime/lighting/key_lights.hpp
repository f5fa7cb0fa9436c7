// Parts light from infinity into key lights, which a few SH bands cannot carry (suns, also those in a
// environment map's picture, lamps, windows, soft boxes), and the rest, which they can. Comes in: the lights
// in their own frame. Goes out: the keys as uniform discs, and the lights without them; keys and rest are all
// the light, for each channel. Whether there are keys, and how many, follows from the loss (light_loss.hpp).
// Turning, fading and dimming the lights later moves, fades and dims the keys, but never changes which there
// are. Pure CPU, safe to call from any thread; takes a fraction of a second for a large picture, and no more
// than reading it once where there are no keys.
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::lighting {

struct KeyLightOptions {
  std::uint32_t most = 16;   // key lights; 0: none are sought
  int order = 5;             // SH bands that carry the rest
  double least_loss = 0.01;  // where the rest loses less than this, no more keys are sought
  // Larger lights are divided. Where the most keys of the first radius (8 degrees) do not suffice, they may
  // be wider, up to the second. About: a key may be a tenth larger.
  float largest_radius_rad = 0.14f, widest_radius_rad = 0.28f;
};

// Where a key light was found.
struct KeyOrigin {
  bool in_map = false;    // else it is a disc, or a piece of one
  std::size_t index = 0;  // among lights.environment maps or lights.discs; of several environment maps the
                          // one with most of it
  bool piece = false;     // of a disc that was divided
};

// A texel of lights.environment maps that gave light to a key.
struct KeyTexel {
  std::uint32_t environment_map = 0, texel = 0, key = 0;
};

struct PartedLights {
  std::vector<spec::Disc> keys;    // those that lose most first
  std::vector<KeyOrigin> origins;  // as keys
  std::vector<KeyTexel> texels;
  std::vector<spec::Disc> discs;  // of the rest; the constant is all in the rest
  // As lights.environment maps: the picture without its keys, or none where it stays as it is.
  std::vector<std::optional<spec::EnvironmentMap>> environment_maps;
  // Of all light at options.order, and of what remains after parting: of the rest, together with what the
  // keys' round shape gets wrong.
  double loss_before = 0.0, loss_after = 0.0;
  // Luminance that the rest keeps where a key was taken out of a picture; 0 where none was.
  float threshold = 0.0f;
};

PartedLights partLights(const spec::DistantLights& lights, const KeyLightOptions& options = {});

}  // namespace lambent::lighting
