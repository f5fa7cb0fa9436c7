// These are the options of a reference picture, beside scene, lights and camera. All of them but the number
// of threads decide the picture's bytes.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/base/result.hpp"
#include "runtime/spec/size.hpp"

namespace lambent::baker::reference {

// Limits a picture to the lighting of precomputed transfer. Light from infinity, and spheres and discs of
// light as seen from each point that they light, are cut to their first `in` bands, for the first hit and
// bounces alike; a ray that meets no surface sees that light, however near it may be. Emissive surfaces and
// punctual lights stay whole. If `out` is given, the BRDF times the cosine at the first hit is replaced by
// its first `out` bands, and light below the surface's plane is blocked where something stands in the
// mirrored direction (docs/conventions.md, "Materials"). The phase function is cut in the same way where a
// volume scatters towards the eye. The sky that the eye sees, also through volumes, stays whole.
struct BandLimit {
  int in = 5;
  std::optional<int> out = {};
};

// Parses IN or IN,OUT, each 1..8.
Result<BandLimit> parseBandLimit(std::string_view word);

struct Options {
  spec::Size size = {};
  std::uint32_t spp = 256;  // samples per pixel, 1..kMaxSpp
  std::uint32_t seed = 0;   // pictures of two seeds have independent noise
  std::optional<BandLimit> band_limit = {};
  // This limits interreflections between surfaces; without a value there are as many as matter. 0 means
  // direct light, and single scattering in volumes; with any other number volumes scatter without a limit.
  std::optional<std::uint32_t> bounces = {};
  float rotate_light_deg = 0.0f;
  unsigned threads = 0;  // 0 means as many as the machine has
};

inline constexpr std::uint32_t kMaxSpp = 1u << 24;

// Errors: a number is outside its range.
Result<void> checkOptions(const Options& options);

}  // namespace lambent::baker::reference
