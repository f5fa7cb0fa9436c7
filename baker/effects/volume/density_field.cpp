#include "baker/effects/volume/density_field.hpp"

#include <cassert>

#include <glm/matrix.hpp>

namespace lambent::baker {

DensityField::DensityField(const glm::uvec3& size, std::span<const float> density,
                           const glm::mat4& group_from_grid)
    : size_(size),
      group_from_grid_(group_from_grid),
      grid_from_group_(glm::inverse(glm::dmat4(group_from_grid))),
      points_(glm::ivec3(size) + 2),
      blocks_((points_ - 2 + kBlock) / kBlock) {
  assert(density.size() == std::size_t{size.x} * size.y * size.z);
  const glm::ivec3 last = glm::ivec3(size) - 1;
  const auto at = [&](const glm::ivec3& point) {
    const glm::uvec3 voxel(glm::clamp(point - 1, glm::ivec3(0), last));
    return density[voxel.x + std::size_t{size.x} * (voxel.y + std::size_t{size.y} * voxel.z)];
  };
  brick_of_.assign(static_cast<std::size_t>(blocks_.x) * static_cast<std::size_t>(blocks_.y) *
                       static_cast<std::size_t>(blocks_.z),
                   -1);
  std::vector<float> brick(kBrick);
  for (int z = 0; z < blocks_.z; ++z)
    for (int y = 0; y < blocks_.y; ++y)
      for (int x = 0; x < blocks_.x; ++x) {
        const glm::ivec3 low = kBlock * glm::ivec3(x, y, z);
        bool any = false;
        std::size_t i = 0;
        for (int k = 0; k <= kBlock; ++k)
          for (int j = 0; j <= kBlock; ++j)
            for (int n = 0; n <= kBlock; ++n, ++i) {
              brick[i] = at(low + glm::ivec3(n, j, k));
              any = any || brick[i] != 0.0f;
            }
        if (!any) continue;
        brick_of_[block({x, y, z})] = static_cast<std::int32_t>(bricks_.size() / kBrick);
        bricks_.insert(bricks_.end(), brick.begin(), brick.end());
      }
}

// The box reaches from 1/2 to size + 1/2 in the lattice.
bool DensityField::clip(const LatticeRay& ray, float& begin, float& end) const {
  for (int axis = 0; axis < 3; ++axis) {
    const float low = 0.5f, high = static_cast<float>(size_[axis]) + 0.5f;
    if (ray.direction[axis] == 0.0f) {
      if (ray.origin[axis] < low || ray.origin[axis] > high) return false;
      continue;
    }
    const float a = (low - ray.origin[axis]) * ray.inverse[axis],
                b = (high - ray.origin[axis]) * ray.inverse[axis];
    begin = std::max(begin, std::min(a, b));
    end = std::min(end, std::max(a, b));
  }
  return begin < end;
}

float DensityField::atGrid(const glm::vec3& grid) const {
  if (glm::any(glm::lessThan(grid, glm::vec3(0.0f))) || glm::any(glm::greaterThan(grid, glm::vec3(size_))))
    return 0.0f;
  const glm::vec3 at = grid + 0.5f;
  const glm::ivec3 cell = glm::clamp(glm::ivec3(glm::floor(at)), glm::ivec3(0), points_ - 2),
                   b = cell / kBlock;
  if (brick_of_[block(b)] < 0) return 0.0f;
  return corners(brickAt(b), cell - kBlock * b).at(glm::clamp(at - glm::vec3(cell), 0.0f, 1.0f));
}

float DensityField::opticalDepth(const glm::vec3& origin, const glm::vec3& direction, float t_max) const {
  float sum = 0.0f;
  const auto any_length = [](float) { return std::numeric_limits<float>::infinity(); };
  march(origin, direction, t_max, any_length, [&](float, float, float depth) {
    sum += depth;
    return sum < kOpaqueDepth;
  });
  return sum;
}

}  // namespace lambent::baker
