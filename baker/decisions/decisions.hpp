// Lists what was decided about each effect that a bake may have, for each rigid group and each of its
// primitives, with a reason that holds its number. A scene and its plan come in, and no rays are traced; with
// an estimate of the bake, and one of a bake that leaves nothing out, each decision also says what it saves.
// baker/plan decides; this only reports.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "baker/bake/options.hpp"
#include "baker/import/scene.hpp"
#include "baker/pipeline/bake_estimate.hpp"
#include "baker/plan/effect_plan.hpp"

namespace lambent::baker {

enum class Choice : std::uint8_t {
  Baked,
  LeftOut,  // it would change less than the bake's error, or something else shows it
  Absent    // there is nothing in the scene that it could show
};
const char* choiceName(Choice choice);  // "baked", "leftOut", "absent"

struct Figure {
  std::string name;
  double value = 0.0;
  std::string unit;
};

// Saved is the cost that an effect has if it is baked and spares if it is left out. Values that nobody knows
// are not set.
struct Saved {
  std::optional<double> seconds, memory_bytes, bytes;  // processor time; at the bake; in the bundle
};
inline constexpr Saved kSavesNothing{.seconds = 0.0, .memory_bytes = 0.0, .bytes = 0.0};

struct Decision {
  std::string effect;
  Choice choice = Choice::Baked;
  std::string reason = {};  // one sentence with its number
  std::vector<Figure> figures = {};
  Saved saves = {};
};

struct PrimitiveDecisions {
  std::size_t draw = 0;  // in the group
  std::vector<Decision> decisions;
};

struct GroupDecisions {
  std::vector<Decision> decisions;
  std::vector<PrimitiveDecisions> primitives;
};

// Estimates of one scene: of the bake as planned, and of one with --effects all. Null: not asked for.
struct Estimates {
  const BakeEstimate* planned = nullptr;
  const BakeEstimate* all = nullptr;
};

// A Decided is what the decisions are about.
struct Decided {
  const Scene& scene;
  const BakeOptions& options;
  const EffectPlan& plan;
  Estimates estimates;
};

// Returns one entry per group of the plan.
std::vector<GroupDecisions> decisionsOf(const Decided& decided);

// Returns what the whole bake saves by what is left out, or nothing without estimates.
std::optional<Saved> savedByAll(const Estimates& estimates);

// Parts of the above, of one group.
std::vector<Decision> groupDecisions(const Decided& decided, std::size_t group);
std::vector<Decision> primitiveDecisions(const Decided& decided, std::size_t group, std::size_t draw);

}  // namespace lambent::baker
