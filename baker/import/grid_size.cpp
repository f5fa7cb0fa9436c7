#include <algorithm>

#include <fmt/format.h>

#include "baker/import/density_file.hpp"

namespace lambent::baker {

Result<void> checkGridSize(const glm::u64vec3& size, const std::string& subject) {
  const bool sides =
      std::max({size.x, size.y, size.z}) <= kMostVoxelsAlongAnAxis && std::min({size.x, size.y, size.z}) >= 1;
  if (sides && size.x * size.y * size.z <= kMostVoxels) return {};
  return fail(subject, fmt::format("has {} x {} x {} voxels", size.x, size.y, size.z),
              fmt::format("save it with 1 to {} along each axis, {} at most in all", kMostVoxelsAlongAnAxis,
                          kMostVoxels));
}

}  // namespace lambent::baker
