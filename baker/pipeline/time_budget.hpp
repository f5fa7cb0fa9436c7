// Chooses the options of a bake that is to take about a given time on this machine (`lambent bake --time`).
// The presets are rehearsed from the coarsest on (bake_estimate.hpp), and rays, refinement and codes are
// chosen between the last that fits and the first that does not. What is chosen are plain options: given by
// hand, they make the same bytes on any machine. Errors: those of the bake.
#pragma once

#include <string>

#include "baker/bake/bake.hpp"

namespace lambent::baker {

struct TimedOptions {
  BakeOptions options;
  double seconds = 0.0;  // what they are expected to take
  std::string words;     // as on the command line: "--quality draft --rays 400 ..."
};

// `seconds` is what may be spent from now on, rehearsals included. Rays, refinement and codes that were asked
// for stay as they are; so do codes where surfaces are glossy, since a bound that is given is kept there at
// any price.
Result<TimedOptions> optionsForTime(const Scene& scene, const BakeOptions& asked, double seconds,
                                    const BakeContext& context);

// Returns options between two, in even ratios: those of `coarse` at 0, and of `fine`, but for what follows
// from its quality alone, at 1. What is not left to choose in `asked` stays.
BakeOptions between(const BakeOptions& coarse, const BakeOptions& fine, const BakeOptions& asked, double at);

}  // namespace lambent::baker
