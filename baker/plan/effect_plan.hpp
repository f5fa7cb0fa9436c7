// The room baker/plan decides what will be baked for a scene, what will not, and why: only the effects that a
// scene calls for are simulated. A scene comes in; its rigid groups, their lights, light probes and
// neighborhoods, and a reason for each choice go out. Each effect decides for itself whether the scene calls
// for it (baker/effects/effect_list.hpp), and `lambent plan` prints the outcome. Planning is deterministic,
// runs on the calling thread and has no errors.
#pragma once

#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "baker/import/scene.hpp"
#include "baker/plan/local_light.hpp"
#include "baker/plan/neighborhoods.hpp"
#include "baker/plan/planned_transport.hpp"
#include "baker/plan/rigid_groups.hpp"

namespace lambent::baker {

struct EffectChoice {
  std::string effect;
  bool baked = false;
  std::string reason;  // one sentence, which is true either way
};

// EffectEntry is one entry of the list of effects.
struct EffectEntry {
  const char* name;
  EffectChoice (*choose)(const Scene& scene, const std::vector<RigidGroup>& groups);
};

struct EffectPlan {
  std::vector<RigidGroup> groups;
  std::vector<EffectChoice> effects;
  std::vector<PlannedTransport> transport;         // one per group
  std::vector<PlannedNeighborhood> neighborhoods;  // one per group; none is baked without that effect
  std::vector<PlannedLightProbes> light_probes;    // one per group
  std::vector<std::string> shadowed_lights;        // one sentence for each lamp that comes within a group
  // Each sentence names something that the scene has and the bake will not show.
  std::vector<std::string> left_out;

  bool bakes(std::string_view effect) const;
};

// `with_insides` keeps the backs of closed double-sided bodies, which nobody sees (closed_bodies.hpp).
EffectPlan makePlan(const Scene& scene, std::span<const EffectEntry> effects, bool with_insides = false);

}  // namespace lambent::baker
