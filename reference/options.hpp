// Declares the options of a reference picture, apart from scene, lights and camera. All but the number of
// threads and the memory affect the picture's bytes.
#pragma once

#include <cstdint>
#include <optional>

#include "runtime/base/result.hpp"
#include "runtime/spec/camera.hpp"

namespace lambent::baker::reference {

// Limits a picture to the lighting that precomputed transfer can represent. Distant light, and sphere and
// disc lights as seen from each point that they light, are cut to their first `in` SH bands, at the first hit
// and at bounces alike; a ray that hits no surface sees that light, however near the source is. Emissive
// surfaces and punctual lights are not limited. If `out` is given, the BRDF times the cosine at the first hit
// is replaced by its first `out` bands, and light from below the surface's plane is blocked if there is an
// occluder in the mirrored direction (docs/conventions.md, "Materials"). The phase function is cut in the
// same way where a volume scatters towards the eye. The sky that the eye sees, also through volumes, is not
// limited.
struct BandLimit {
  int in = 5;
  std::optional<int> out = {};
};

// Parses IN or IN,OUT, each 1..8.
Result<BandLimit> parseBandLimit(std::string_view word);

struct Options {
  spec::Size size = {};
  std::uint32_t spp = 256;  // samples per pixel, 1..kMaxSpp
  std::uint32_t seed = 0;   // different seeds give independent noise
  std::optional<BandLimit> band_limit = {};
  // Maximum number of reflections between surfaces; none: no limit. 0 means direct light, and single
  // scattering in volumes; with any other number scattering in volumes is not limited.
  std::optional<std::uint32_t> bounces = {};
  float rotate_light_deg = 0.0f;
  unsigned threads = 0;  // 0: as many as the machine has
  // What the whole program may take; 0: what the machine has. A picture cannot do with less than it needs, so
  // what needs more is refused (checkMemory() in reference.cpp).
  std::uint64_t memory_bytes = 0;
};

inline constexpr std::uint32_t kMaxSpp = 1u << 24;

// Errors: a number is outside its range.
Result<void> checkOptions(const Options& options);

}  // namespace lambent::baker::reference
