#include "runtime/lighting/patches.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

namespace lambent::lighting {

namespace {

// These lengths are relative to the extent of the patches.
constexpr float kLift = 2e-4f;
constexpr float kLeastThickness = 2e-3f;
constexpr float kOnPlane = 1e-5f;

constexpr float kSameWay = 0.5f;  // least cosine between normals of surfaces that face the same way

// These are the barycentric coordinates of the centres of the four parts of a triangle whose edges are
// halved.
constexpr std::array<glm::vec3, kPatchPoints> kPointWeights = {
    glm::vec3(1.0f / 3.0f, 1.0f / 3.0f, 1.0f / 3.0f), glm::vec3(2.0f / 3.0f, 1.0f / 6.0f, 1.0f / 6.0f),
    glm::vec3(1.0f / 6.0f, 2.0f / 3.0f, 1.0f / 6.0f), glm::vec3(1.0f / 6.0f, 1.0f / 6.0f, 2.0f / 3.0f)};

// Returns into how many parts an edge is cut. Areas are weighed by the patches that they deserve.
std::uint32_t partsFor(float area, float wanted) {
  return wanted > 0.0f ? std::max(1u, static_cast<std::uint32_t>(std::lround(std::sqrt(area / wanted)))) : 1u;
}

}  // namespace

TrianglePart TrianglePart::at(std::uint32_t parts, float b, float c) {
  const float x = std::max(b, 0.0f) * static_cast<float>(parts);
  const float y = std::max(c, 0.0f) * static_cast<float>(parts);
  const auto row = std::min(static_cast<std::uint32_t>(y), parts - 1);
  const auto column = std::min(static_cast<std::uint32_t>(x), parts - 1 - row);
  const bool has_upper = column + row < parts - 1;
  const bool upper = has_upper && (x - static_cast<float>(column)) + (y - static_cast<float>(row)) > 1.0f;
  return {.column = column, .row = row, .upper = upper};
}

Patches::Patches(const bundle::PatchSurface& surface, std::size_t most) {
  if (surface.triangles.empty()) return;
  std::vector<RayTriangle> triangles;
  std::vector<float> areas, weighed;
  float whole = 0.0f;
  bool any_detail = false;
  glm::vec3 low(INFINITY), high(-INFINITY);
  for (const bundle::PatchTriangle& triangle : surface.triangles) {
    std::array<glm::vec3, 3> corners{};
    for (std::size_t k = 0; k < 3; ++k) {
      corners[k] = surface.positions[triangle.vertices[k]];
      low = glm::min(low, corners[k]);
      high = glm::max(high, corners[k]);
    }
    const glm::vec3 across = glm::cross(corners[1] - corners[0], corners[2] - corners[0]);
    const float length = glm::length(across);
    normals_.push_back(length > 0.0f ? across / length : glm::vec3(0.0f, 1.0f, 0.0f));
    areas.push_back(0.5f * length);
    weighed.push_back(areas.back() * bundle::patchDensity(triangle.detail));
    whole += weighed.back();
    any_detail |= triangle.detail > 0;
    triangles.push_back({.corners = corners, .front_only = triangle.front_only});
  }
  extent_ = glm::distance(low, high);
  // The bake knows the extent of what is seen, which may be small beside the bounds, and its error is at
  // least a share of it.
  if (any_detail) extent_ = std::min(extent_, surface.error_m / kLeastThickness);
  error_ = std::max(surface.error_m, kLeastThickness * extent_);
  tree_ = TriangleTree(std::move(triangles), kOnPlane * extent_);
  // Rounding gives some triangles more parts than their share; then all get a little fewer.
  float wanted = whole / static_cast<float>(std::max<std::size_t>(most, 1));
  for (int tries = 0; tries < 32; ++tries) {
    std::size_t count = 0;
    for (const float area : weighed) count += std::size_t{partsFor(area, wanted)} * partsFor(area, wanted);
    if (count <= most) break;
    wanted *= 1.1f;
  }
  for (std::size_t t = 0; t < tree_.size(); ++t) {
    const std::uint32_t parts = partsFor(weighed[t], wanted);
    split_.push_back({.first = patches_.size(), .parts = parts});
    const auto& [a, b, c] = tree_[t].corners;
    const auto cornerAt = [&](std::uint32_t column, std::uint32_t row) {
      const glm::vec2 at = glm::vec2(column, row) / static_cast<float>(parts);
      return a + at.x * (b - a) + at.y * (c - a);
    };
    for (std::uint32_t row = 0; row < parts; ++row)
      for (std::uint32_t place = 0; place < 2 * (parts - row) - 1; ++place) {
        const std::uint32_t i = place / 2;
        const bool upper = place % 2 != 0;
        const glm::vec3 p = upper ? cornerAt(i + 1, row + 1) : cornerAt(i, row);
        const glm::vec3 q = cornerAt(i + 1, row), r = cornerAt(i, row + 1);
        Patch& patch = patches_.emplace_back();
        for (std::size_t k = 0; k < kPatchPoints; ++k)
          patch.points[k] = kPointWeights[k].x * p + kPointWeights[k].y * q + kPointWeights[k].z * r;
        patch.normal = normals_[t];
        patch.area = areas[t] / static_cast<float>(parts * parts);
        patch.albedo = surface.triangles[t].albedo;
      }
  }
  for (Patch& patch : patches_)
    for (std::size_t k = 0; k < kPatchPoints; ++k) patch.origins[k] = inFront(patch.points[k], patch.normal);
}

std::size_t Patches::patchAt(const RayHit& hit) const {
  const Split& split = split_[hit.triangle];
  return split.first + TrianglePart::at(split.parts, hit.b, hit.c).place(split.parts);
}

float Patches::beside(std::size_t triangle, const glm::vec3& point) const {
  float outside = 0.0f;
  for (std::size_t k = 0; k < 3; ++k) {
    const glm::vec3& corner = tree_[triangle].corners[k];
    const glm::vec3 inwards = glm::cross(normals_[triangle], tree_[triangle].corners[(k + 1) % 3] - corner);
    const float length = glm::length(inwards);
    if (length > 0.0f) outside = std::max(outside, -glm::dot(inwards, point - corner) / length);
  }
  return outside;
}

glm::vec3 Patches::inFront(glm::vec3 point, const glm::vec3& normal) const {
  const float lift = kLift * extent_;
  point += lift * normal;
  std::vector<std::uint32_t> around;
  tree_.findNear(point, 2.0f * (error_ + lift), around);
  const auto heightOver = [&](std::uint32_t t) { return glm::dot(normals_[t], point - tree_[t].corners[0]); };
  // The patches' error is that of their worst place. Here they are as far away as the nearest of them that
  // faces the same way. If the point lies farther behind another, that is the other side of something thin,
  // or another body.
  float here = error_;
  for (const std::uint32_t t : around)
    if (glm::dot(normals_[t], normal) > kSameWay)
      here = std::min(here, std::max(std::abs(heightOver(t)), beside(t, point)));
  here = std::max(here, kLeastThickness * extent_);
  for (const std::uint32_t t : around) {
    const float height = heightOver(t);
    if (height > 0.5f * lift || height < -here || glm::dot(normals_[t], normal) < -0.5f ||
        beside(t, point) > here)
      continue;
    // The point must not move through to the other side of something thin that it is in front of.
    const auto inTheWay = [&](std::uint32_t other) {
      if (glm::dot(normals_[other], normals_[t]) > -0.9f) return false;
      const float above = heightOver(other);
      return above >= 0.0f && above <= lift - height && beside(other, point) <= here;
    };
    if (std::ranges::none_of(around, inTheWay)) point += (lift - height) * normals_[t];
  }
  return point;
}

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
