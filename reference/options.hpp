// What a reference picture is asked for, beside scene, lights and camera. Everything here but the number of
// threads decides the picture's bytes.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/base/result.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

// The lighting of a precomputed picture: light from infinity, and spheres and discs of light as seen from
// each point that they light, first hit and bounces alike, cut to their first `in` bands; a ray that meets no
// surface sees that, however near the light may stand. Emissive surfaces and punctual lights stay whole. And,
// where `out` is given, the BRDF times the cosine at the first hit replaced by its first `out` bands, with
// the light below the surface's plane mirrored where something stands in the mirrored direction
// (docs/conventions.md, "Materials"); and so the phase function where a volume scatters towards the eye. The
// sky that the eye sees, through volumes too, stays whole.
struct BandLimit {
  int in = 5;
  std::optional<int> out = {};
};

// IN or IN,OUT, each 1..8.
Result<BandLimit> parseBandLimit(std::string_view word);

struct Options {
  spec::Size size = {};
  std::uint32_t spp = 256;  // samples a pixel, 1..kMaxSpp
  std::uint32_t seed = 0;   // pictures of two seeds have independent noise
  std::optional<BandLimit> band_limit = {};
  // Interreflections between surfaces; none: as many as matter. 0 is direct light, and single scattering in
  // volumes; with any other number volumes scatter without a limit.
  std::optional<std::uint32_t> bounces = {};
  float rotate_light_deg = 0.0f;
  unsigned threads = 0;  // 0: as many as the machine has
};

inline constexpr std::uint32_t kMaxSpp = 1u << 24;

// Errors: a number outside its range.
Result<void> checkOptions(const Options& options);

}  // namespace lambent::baker::reference
