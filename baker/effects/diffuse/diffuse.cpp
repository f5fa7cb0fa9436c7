#include "baker/effects/diffuse/diffuse.hpp"

#include <string>

#include <fmt/format.h>

#include "baker/plan/counted.hpp"
#include "baker/plan/group_lights.hpp"

namespace lambent::baker {

EffectChoice chooseDiffuse(const Scene& scene, const std::vector<RigidGroup>& groups) {
  std::size_t draws = 0, mapped = 0, lights = 0;
  for (const RigidGroup& group : groups) {
    draws += group.draws.size();
    lights += findGroupLights(scene, group).size();
    for (const PlannedDraw& draw : group.draws) {
      const std::int32_t material = scene.meshes[draw.mesh].primitives[draw.primitive].material;
      mapped +=
          material >= 0 && scene.materials[static_cast<std::size_t>(material)].normal_texture.texture >= 0;
    }
  }
  if (draws == 0) return {"diffuse", false, "there are no surfaces"};
  std::string reason =
      fmt::format("{} of surfaces in {}", counted(draws, "draw"), counted(groups.size(), "rigid group"));
  if (lights > 0) reason += fmt::format("; {} of their own", counted(lights, "light"));
  if (mapped > 0) reason += fmt::format("; {} with a normal map", counted(mapped, "draw"));
  return {"diffuse", true, reason};
}

}  // namespace lambent::baker
