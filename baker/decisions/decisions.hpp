// Lists what was decided about each effect that a bake may have, for each rigid group and each of its
// primitives, with a reason that holds its number. A scene and its plan come in, and no rays are traced.
// baker/plan decides; this only reports.
#pragma once

#include <string>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

enum class Choice : std::uint8_t {
  Baked,
  LeftOut,  // it would change less than the bake's error, or something else shows it
  Absent    // there is nothing in the scene that it could show
};
const char* choiceName(Choice choice);  // "baked", "leftOut", "absent"

struct Decision {
  std::string effect;
  Choice choice = Choice::Baked;
  std::string reason = {};  // one sentence with its number
};

struct PrimitiveDecisions {
  std::size_t draw = 0;  // in the group
  std::vector<Decision> decisions;
};

struct GroupDecisions {
  std::vector<Decision> decisions;
  std::vector<PrimitiveDecisions> primitives;
};

// A Decided is what the decisions are about.
struct Decided {
  const Scene& scene;
  const BakeOptions& options;
  const EffectPlan& plan;
};

// Returns one entry per group of the plan.
std::vector<GroupDecisions> decisionsOf(const Decided& decided);

}  // namespace lambent::baker
