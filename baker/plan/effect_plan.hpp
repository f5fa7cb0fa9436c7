// What will be baked for a scene, what not, and why: "simulate only the effects that a scene calls for". Each
// effect says for itself whether the scene calls for it (baker/effects/effect_list.hpp); `lambent plan`
// prints the outcome.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

struct EffectChoice {
  std::string effect;
  bool baked = false;
  std::string reason;  // one sentence, true either way
};

// One line of the list of effects.
struct EffectEntry {
  const char* name;
  EffectChoice (*choose)(const Scene& scene, const std::vector<RigidGroup>& groups);
};

struct EffectPlan {
  std::vector<RigidGroup> groups;
  std::vector<EffectChoice> effects;
  std::vector<PlannedNeighborhood> neighborhoods;  // one per group; none baked without that effect
  std::vector<PlannedLightProbes> light_probes;    // one per group
  std::vector<std::string> shadowed_lights;        // lamps that come within groups, and how they are shown
  std::vector<std::string> left_out;  // what the scene has and the bake will not show, one sentence each

  bool bakes(std::string_view effect) const;
};

EffectPlan makePlan(const Scene& scene, std::span<const EffectEntry> effects);

}  // namespace lambent::baker
