// How a film fills: in passes, of samples of a pixel that walk together. Where passes begin and end decides
// the last bits of a picture (sums are rounded, rays travel in packets), with a band limit its kernels too:
// whoever draws the same pictures must cut them alike, and so both render() and ProgressiveReference go by
// this.
#pragma once

#include <cstdint>
#include <stop_token>

#include "baker/jobs/progress.hpp"
#include "reference/film.hpp"

namespace lambent::baker::reference {

// Samples of a pixel in one pass.
std::uint32_t samplesInPass(const Options& options, const Volumes& volumes);

// Rows between two looks at the clock.
inline constexpr std::uint32_t kRowsAtOnce = 32;

// Brings rows [first, last) to `samples` a pixel; in parallel. False when stopped: rows in hand are given up,
// so that it takes no longer than a few pixels.
bool addSamples(const Integrator& integrator, Film& film, std::uint32_t first, std::uint32_t last,
                std::uint32_t samples, Progress& progress, const std::stop_token& stop);

}  // namespace lambent::baker::reference
