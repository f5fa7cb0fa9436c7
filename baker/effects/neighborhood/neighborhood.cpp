#include "baker/effects/neighborhood/neighborhood.hpp"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/neighborhoods.hpp"

namespace lambent::baker {

EffectChoice chooseNeighborhood(const Scene& scene, const std::vector<RigidGroup>& groups) {
  const std::vector<PlannedNeighborhood> plans = planNeighborhoods(scene, groups);
  std::vector<std::string> names;
  std::string against;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    if (plans[k].baked)
      names.push_back(groups[k].name);
    else if (against.empty() && !plans[k].reason.empty())
      against = fmt::format("{}: {}", groups[k].name, plans[k].reason);
  }
  if (names.empty())
    return {
        "neighborhood", false,
        against.empty() ? "no body comes within the bounds of a group of more than twice its size" : against};
  return {
      "neighborhood", true,
      fmt::format("grids of matrices around {}: their shadows, and light that they reflect, on what comes "
                  "near",
                  fmt::join(names, ", "))};
}

}  // namespace lambent::baker
