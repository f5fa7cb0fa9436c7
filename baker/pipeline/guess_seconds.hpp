// Guesses what a bake takes from its plan, its vertices and which way its faces look, which costs nothing. A
// guess may be wrong by a factor of two, of small scenes by four.
#pragma once

#include <optional>
#include <string>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/whole_progress.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

struct BakeGuess {
  double samples = 0.0, rays = 0.0;  // of surfaces
  PartSeconds seconds;               // on the threads that the options give it of this machine
  double processor_seconds = 0.0;    // on a processor of about 2020
  double memory_bytes = 0.0;         // of transfer of the largest group while it is baked
};
BakeGuess guessBake(const Scene& scene, const EffectPlan& plan, const BakeOptions& options);

// Returns a sentence for a bake that takes so much processor time, so that nobody waits for minutes unwarned,
// or nothing if that is not long.
std::optional<std::string> longBakeNotice(double processor_seconds);

}  // namespace lambent::baker
