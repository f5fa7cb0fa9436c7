#include "runtime/lighting/patch_regions.hpp"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lambent::lighting {

PatchRegions::PatchRegions(const Patches& patches) : patch_count_(patches.size()) {
  for (std::size_t t = 0; t < patches.tree().size(); ++t) {
    const std::uint32_t parts = patches.partsOf(t);
    corners_.push_back(patches.tree()[t].corners);
    std::vector<Level>& levels = levels_.emplace_back();
    levels.push_back({.parts = parts, .first = patches.firstOf(t)});
    for (std::uint32_t coarse = parts; coarse > 1;) {
      coarse = (coarse + 1) / 2;
      levels.push_back({.parts = coarse, .first = size()});
      members_.resize(members_.size() + std::size_t{coarse} * coarse);
      const std::size_t first = levels.back().first - patch_count_;
      for (std::uint32_t row = 0; row < parts; ++row)
        for (std::uint32_t column = 0; column < parts - row; ++column)
          for (const bool upper : {false, true}) {
            if (upper && column + row + 1 >= parts) continue;
            const float third = upper ? 2.0f / 3.0f : 1.0f / 3.0f;
            const glm::vec2 middle = (glm::vec2(column, row) + third) / static_cast<float>(parts);
            const std::size_t patch =
                patches.firstOf(t) + TrianglePart{.column = column, .row = row, .upper = upper}.place(parts);
            members_[first + TrianglePart::at(coarse, middle.x, middle.y).place(coarse)].push_back(
                static_cast<std::uint32_t>(patch));
          }
    }
  }
}

std::size_t PatchRegions::regionAt(const RayHit& hit, std::size_t level) const {
  const Level& of = levels_[hit.triangle][level];
  return of.first + TrianglePart::at(of.parts, hit.b, hit.c).place(of.parts);
}

float PatchRegions::areaOf(std::size_t triangle, std::size_t level) const {
  const auto& [a, b, c] = corners_[triangle];
  const auto parts = static_cast<float>(levels_[triangle][level].parts);
  return 0.5f * glm::length(glm::cross(b - a, c - a)) / (parts * parts);
}

std::array<glm::vec3, 3> PatchRegions::cornersAt(const RayHit& hit, std::size_t level) const {
  constexpr float kDrawnIn = 0.1f;
  const auto& [a, b, c] = corners_[hit.triangle];
  const std::uint32_t parts = levels_[hit.triangle][level].parts;
  const TrianglePart part = TrianglePart::at(parts, hit.b, hit.c);
  const glm::vec2 low(part.column, part.row);
  std::array<glm::vec2, 3> at = {low, low + glm::vec2(1, 0), low + glm::vec2(0, 1)};
  if (part.upper) at[0] += 1.0f;
  const glm::vec2 middle = (at[0] + at[1] + at[2]) / 3.0f;
  std::array<glm::vec3, 3> corners{};
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec2 weights = glm::mix(at[k], middle, kDrawnIn) / static_cast<float>(parts);
    corners[k] = a + weights.x * (b - a) + weights.y * (c - a);
  }
  return corners;
}

std::vector<glm::vec3> PatchRegions::means(std::span<const glm::vec3> by_patch) const {
  std::vector<glm::vec3> all(by_patch.begin(), by_patch.end());
  for (const std::vector<std::uint32_t>& members : members_) {
    glm::vec3 sum(0.0f);
    for (const std::uint32_t patch : members) sum += by_patch[patch];
    all.push_back(members.empty() ? sum : sum / static_cast<float>(members.size()));
  }
  return all;
}

}  // namespace lambent::lighting
