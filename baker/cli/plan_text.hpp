// Prints a plan as text that fits one screen: warnings first, then effects and the largest groups, whose
// primitives are summed up by decision. All of it is in --verbose.
#pragma once

#include <string>
#include <vector>

#include "baker/decisions/decisions.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/guess_seconds.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

// A plan with all that is reported about it.
struct PlanReport {
  const Scene& scene;
  const EffectPlan& plan;
  const std::vector<GroupDecisions>& decisions;  // one per group
  const BakeGuess& guess;
};

struct GroupSize {
  std::size_t vertices = 0, triangles = 0;
};
GroupSize sizeOf(const Scene& scene, const RigidGroup& group);

// Empty for the default material and for one without a name.
std::string materialName(const Scene& scene, std::int32_t material);

void printPlan(const PlanReport& report, bool verbose);

}  // namespace lambent::baker
