#include "runtime/lighting/triangle_rays.hpp"

#include <algorithm>
#include <bit>
#include <cmath>

#include <glm/geometric.hpp>

namespace lambent::lighting {

namespace {

constexpr std::uint32_t kNothing = 0xffffffffu;

}  // namespace

void TriangleSet::add(const RayTriangle& triangle) {
  ++count_;
  for (std::size_t corner = 0; corner < 3; ++corner)
    for (int axis = 0; axis < 3; ++axis)
      corners_[3 * corner + static_cast<std::size_t>(axis)].push_back(triangle.corners[corner][axis]);
  const auto& [a, b, c] = triangle.corners;
  double_area_.push_back(glm::length(glm::cross(b - a, c - a)));
  front_only_.push_back(triangle.front_only ? 1 : 0);
}

RayTriangle TriangleSet::operator[](std::size_t index) const {
  RayTriangle triangle{.corners = {}, .front_only = front_only_[index] != 0};
  for (std::size_t k = 0; k < 9; ++k) triangle.corners[k / 3][static_cast<int>(k % 3)] = corners_[k][index];
  return triangle;
}

RaysFrom::RaysFrom(const TriangleSet& set, float least_distance)
    : set_(set), least_distance_(least_distance) {
  for (std::vector<float>& plane : planes_) plane.resize(set.size());
  volume_.resize(set.size());
  index_.resize(set.size());
  back_.resize(set.size());
  distance_.resize(set.size());
}

void RaysFrom::moveTo(const glm::vec3& origin) {
  moveTo(origin, glm::vec3(0.0f));
}

void RaysFrom::moveTo(const glm::vec3& origin, const glm::vec3& normal) {
  count_ = 0;
  const auto corner = [&](std::size_t k, std::size_t i) {
    return glm::vec3(set_.corners_[3 * k][i], set_.corners_[3 * k + 1][i], set_.corners_[3 * k + 2][i]) -
           origin;
  };
  for (std::size_t i = 0; i < set_.size(); ++i) {
    const glm::vec3 a = corner(0, i), b = corner(1, i), c = corner(2, i);
    if (glm::dot(a, normal) < 0.0f && glm::dot(b, normal) < 0.0f && glm::dot(c, normal) < 0.0f) continue;
    const glm::vec3 bc = glm::cross(b, c);
    const float volume = glm::dot(a, bc);  // negative for front hits
    const bool back = volume > 0.0f;
    const bool on_plane = !(std::abs(volume) > least_distance_ * set_.double_area_[i]);
    if (on_plane || (back && set_.front_only_[i] != 0)) continue;
    const float sign = back ? 1.0f : -1.0f;
    const std::array<glm::vec3, 3> planes = {sign * bc, sign * glm::cross(c, a), sign * glm::cross(a, b)};
    for (std::size_t k = 0; k < 9; ++k) planes_[k][count_] = planes[k / 3][static_cast<int>(k % 3)];
    volume_[count_] = sign * volume;
    index_[count_] = static_cast<std::uint32_t>(i);
    back_[count_] = back ? 1 : 0;
    ++count_;
  }
}

std::optional<RayHit> RaysFrom::first(const glm::vec3& direction) {
  const float x = direction.x, y = direction.y, z = direction.z;
  const float* const ax = planes_[0].data();
  const float* const ay = planes_[1].data();
  const float* const az = planes_[2].data();
  const float* const bx = planes_[3].data();
  const float* const by = planes_[4].data();
  const float* const bz = planes_[5].data();
  const float* const cx = planes_[6].data();
  const float* const cy = planes_[7].data();
  const float* const cz = planes_[8].data();
  const float* const volume = volume_.data();
  std::uint32_t* const distance = distance_.data();
  std::uint32_t nearest = kNothing;
  for (std::size_t i = 0; i < count_; ++i) {
    const float a = x * ax[i] + y * ay[i] + z * az[i];
    const float b = x * bx[i] + y * by[i] + z * bz[i];
    const float c = x * cx[i] + y * cy[i] + z * cz[i];
    const float sum = a + b + c;
    const bool inside = (a >= 0.0f) & (b >= 0.0f) & (c >= 0.0f) & (sum > 0.0f);
    // This has no branch, so that the loop handles several triangles at once. The bits of positive floats
    // order like the floats.
    const std::uint32_t missed = static_cast<std::uint32_t>(inside) - 1u;  // all bits set if missed
    distance[i] = std::bit_cast<std::uint32_t>(volume[i] / sum) | missed;
    nearest = std::min(nearest, distance[i]);
  }
  if (nearest == kNothing) return std::nullopt;
  // If both sides of something without thickness are hit, the one that faces the ray counts.
  std::size_t i = count_;
  for (std::size_t k = 0; k < count_; ++k)
    if (distance[k] == nearest && (i == count_ || back_[i] > back_[k])) i = k;
  const float a = x * ax[i] + y * ay[i] + z * az[i];
  const float b = x * bx[i] + y * by[i] + z * bz[i];
  const float c = x * cx[i] + y * cy[i] + z * cz[i];
  return RayHit{.triangle = index_[i], .b = b / (a + b + c), .c = c / (a + b + c), .back = back_[i] != 0};
}

bool RaysFrom::blocked(const glm::vec3& direction, float lengths) const {
  const float x = direction.x, y = direction.y, z = direction.z;
  std::uint32_t hits = 0;
  for (std::size_t i = 0; i < count_; ++i) {
    const float a = x * planes_[0][i] + y * planes_[1][i] + z * planes_[2][i];
    const float b = x * planes_[3][i] + y * planes_[4][i] + z * planes_[5][i];
    const float c = x * planes_[6][i] + y * planes_[7][i] + z * planes_[8][i];
    const float sum = a + b + c;
    const bool inside = (a >= 0.0f) & (b >= 0.0f) & (c >= 0.0f) & (sum > 0.0f);
    hits |= inside & (volume_[i] < lengths * sum) ? 1u : 0u;
  }
  return hits != 0;
}

}  // namespace lambent::lighting
