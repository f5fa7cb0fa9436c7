// Fills a film in passes of samples that advance together. Where passes begin and end affects the last bits
// of a picture (sums are rounded, rays travel in packets), and with a band limit its kernels too. Whoever
// draws the same pictures must use the same passes, so both render() and ProgressiveReference use these
// functions.
#pragma once

#include <cstdint>
#include <stop_token>

#include "baker/jobs/progress.hpp"
#include "reference/film.hpp"

namespace lambent::baker::reference {

// Returns the samples per pixel in one pass.
std::uint32_t samplesInPass(const Options& options, const Volumes& volumes);

// Rows that are traced between two looks at the clock.
inline constexpr std::uint32_t kRowsAtOnce = 32;

// Brings rows [first, last) to `samples` per pixel, in parallel. Returns false if stopped; rows in progress
// are dropped, so that stopping takes no longer than a few pixels.
bool addSamples(const Integrator& integrator, Film& film, std::uint32_t first, std::uint32_t last,
                std::uint32_t samples, Progress& progress, const std::stop_token& stop);

}  // namespace lambent::baker::reference
