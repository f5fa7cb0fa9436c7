#include "baker/decisions/decisions.hpp"

#include <algorithm>

namespace lambent::baker {

const char* choiceName(Choice choice) {
  switch (choice) {
    case Choice::Baked:
      return "baked";
    case Choice::LeftOut:
      return "leftOut";
    case Choice::Absent:
      break;
  }
  return "absent";
}

std::vector<GroupDecisions> decisionsOf(const Decided& decided) {
  std::vector<GroupDecisions> all;
  for (std::size_t g = 0; g < decided.plan.groups.size(); ++g) {
    GroupDecisions& of = all.emplace_back();
    of.decisions = groupDecisions(decided, g);
    for (std::size_t d = 0; d < decided.plan.groups[g].draws.size(); ++d)
      of.primitives.push_back({d, primitiveDecisions(decided, g, d)});
  }
  return all;
}

std::optional<Saved> savedByAll(const Estimates& estimates) {
  const auto& [planned, all] = estimates;
  if (!planned || !all) return std::nullopt;
  return Saved{.seconds = std::max(0.0, all->processor_seconds - planned->processor_seconds),
               .memory_bytes = std::max(0.0, all->memory_bytes - planned->memory_bytes),
               .bytes = std::max(0.0, all->bytes - planned->bytes)};
}

}  // namespace lambent::baker
