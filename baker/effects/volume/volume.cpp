#include "baker/effects/volume/volume.hpp"

#include <string>
#include <vector>

#include <fmt/format.h>
#include <fmt/ranges.h>

#include "baker/plan/counted.hpp"

namespace lambent::baker {

EffectChoice chooseVolume(const Scene& scene, const std::vector<RigidGroup>&) {
  if (scene.volumes.empty()) return {"volume", false, "no node has a volume"};
  std::vector<std::string> each;
  for (const SceneVolume& volume : scene.volumes) {
    const glm::vec3& w = volume.albedo;
    const bool grey = w.r == w.g && w.g == w.b;
    each.push_back(fmt::format(
        "{} ({} x {} x {} voxels, albedo {})", volume.name, volume.size.x, volume.size.y, volume.size.z,
        grey ? fmt::format("{:.3g}", double{w.r})
             : fmt::format("{:.3g} {:.3g} {:.3g}", double{w.r}, double{w.g}, double{w.b})));
  }
  return {"volume", true,
          fmt::format("{}, light that comes through and that is scattered: {}",
                      counted(scene.volumes.size(), "volume"), fmt::join(each, "; "))};
}

}  // namespace lambent::baker
