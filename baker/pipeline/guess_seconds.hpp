// Guesses what a bake takes from its plan, its vertices and which way its faces look, which costs nothing. A
// guess may be wrong by a factor of two, of small scenes by four; `lambent plan` rehearses the bake and knows
// better.
#pragma once

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/job_estimate.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// Returns about how much processor time, of about 2020's x86, each stage takes.
PartSeconds guessProcessorSeconds(const Scene& scene, const EffectPlan& plan, const BakeOptions& options);

// Returns about how long each stage takes on so many threads of this machine; 0: all.
PartSeconds onThreads(PartSeconds of_processors, unsigned threads);

}  // namespace lambent::baker
