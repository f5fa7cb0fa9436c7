#include "baker/effects/diffuse/diffuse.hpp"

#include <fmt/format.h>

namespace lambent::baker {

EffectChoice chooseDiffuse(const Scene& /*scene*/, const std::vector<RigidGroup>& groups) {
  std::size_t draws = 0;
  for (const RigidGroup& group : groups) draws += group.draws.size();
  if (draws == 0) return {"diffuse", false, "there are no surfaces"};
  return {"diffuse", true,
          fmt::format("{} of surfaces in {}: direct light with shadows",
                      draws == 1 ? "1 draw" : fmt::format("{} draws", draws),
                      groups.size() == 1 ? "1 rigid group" : fmt::format("{} rigid groups", groups.size()))};
}

}  // namespace lambent::baker
