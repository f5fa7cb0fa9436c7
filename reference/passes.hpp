// Fills a film in passes of samples. The boundaries of passes affect the last bits of a picture (rounding of
// sums, ray packets) and, with a band limit, its kernels. render() and ProgressiveReference both use these
// functions, so that their pictures are equal.
#pragma once

#include <cstdint>
#include <stop_token>

#include "baker/jobs/progress.hpp"
#include "reference/film.hpp"

namespace lambent::baker::reference {

// Returns the number of samples per pixel in one pass.
std::uint32_t samplesInPass(const Options& options, const Volumes& volumes);

// The number of rows traced between two checks of the clock.
inline constexpr std::uint32_t kRowsAtOnce = 32;

struct Rows {
  std::uint32_t first, last;  // [first, last)
};

// Brings rows to `samples` per pixel, in parallel. Returns false if stopped; unfinished rows
// are dropped, so stopping takes no longer than a few pixels.
bool addSamples(const Integrator& integrator, Film& film, const Rows& rows, std::uint32_t samples,
                Progress& progress, const std::stop_token& stop);

}  // namespace lambent::baker::reference
