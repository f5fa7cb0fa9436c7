#include "runtime/bundle/volume_grid.hpp"

#include "runtime/base/payload_bytes.hpp"

namespace lambent::bundle {

std::vector<std::byte> encodeVoxels(std::span<const std::uint32_t> voxels) {
  std::vector<std::int32_t> steps(voxels.size());
  for (std::size_t i = 0; i < voxels.size(); ++i)
    steps[i] = static_cast<std::int32_t>(voxels[i] - (i > 0 ? voxels[i - 1] : 0u));
  std::vector<std::byte> bytes;
  appendIntegers(bytes, steps);
  return bytes;
}

Result<std::vector<std::uint32_t>> decodeVoxels(std::span<const std::byte> bytes, const glm::uvec3& grid_size,
                                                const std::string& subject) {
  if (bytes.size() % 4 != 0) return fail(subject, "has a list of voxels that ends in one", "bake it again");
  const std::vector<std::int32_t> steps = Front(bytes).integers(bytes.size() / 4);
  const std::int64_t count = std::int64_t{grid_size.x} * grid_size.y * grid_size.z;
  std::vector<std::uint32_t> voxels;
  voxels.reserve(steps.size());
  std::int64_t voxel = 0;
  for (const std::int32_t step : steps) {
    voxel += step;
    if (step < 0 || (step == 0 && !voxels.empty()) || voxel >= count)
      return fail(subject, "has a list of voxels that is not in order", "bake it again");
    voxels.push_back(static_cast<std::uint32_t>(voxel));
  }
  return voxels;
}

}  // namespace lambent::bundle
