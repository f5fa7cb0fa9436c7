#include "runtime/shadows/key_region.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include <glm/geometric.hpp>
#include <glm/matrix.hpp>
#include <glm/vec4.hpp>
#include <glm/vector_relational.hpp>

namespace lambent::frame {

namespace {

// A point p is inside if dot(plane, (p, 1)) >= 0 for each plane.
using Planes = std::array<glm::dvec4, 12>;

Planes planesOf(const scene::Box& box, const glm::dmat4& clip_from_world) {
  Planes planes;
  const glm::dmat4 rows = glm::transpose(clip_from_world);
  for (int axis = 0; axis < 3; ++axis) {
    planes[static_cast<std::size_t>(2 * axis)] = rows[3] + rows[axis];
    planes[static_cast<std::size_t>(2 * axis + 1)] = rows[3] - rows[axis];
    glm::dvec4 low(0.0), high(0.0);
    low[axis] = 1.0;
    low.w = -double{box.min[axis]};
    high[axis] = -1.0;
    high.w = double{box.max[axis]};
    planes[static_cast<std::size_t>(6 + 2 * axis)] = low;
    planes[static_cast<std::size_t>(7 + 2 * axis)] = high;
  }
  for (glm::dvec4& plane : planes)
    if (const double length = glm::length(glm::dvec3(plane)); length > 0.0) plane /= length;
  return planes;
}

double extent(const scene::Box& box, glm::dvec3 direction, bool most) {
  double sum = 0.0;
  for (int i = 0; i < 3; ++i) {
    const bool upper = (direction[i] > 0.0) == most;
    sum += direction[i] * double{upper ? box.max[i] : box.min[i]};
  }
  return sum;
}

}  // namespace

std::vector<glm::dvec3> seenCorners(const scene::Box& box, const glm::mat4& clip_from_world) {
  std::vector<glm::dvec3> corners;
  if (box.empty()) return corners;
  const Planes planes = planesOf(box, glm::dmat4(clip_from_world));
  const double doubt = 1e-6 * (double{box.radius()} + glm::length(glm::dvec3(box.center()))) + 1e-9;
  const auto inside = [&](glm::dvec3 p) {
    return std::ranges::all_of(
        planes, [&](const glm::dvec4& plane) { return glm::dot(plane, glm::dvec4(p, 1.0)) >= -doubt; });
  };
  // The corners of a convex body are among the points where three of its planes meet.
  for (std::size_t i = 0; i < planes.size(); ++i)
    for (std::size_t j = i + 1; j < planes.size(); ++j)
      for (std::size_t k = j + 1; k < planes.size(); ++k) {
        const glm::dmat3 normals =
            glm::transpose(glm::dmat3(glm::dvec3(planes[i]), glm::dvec3(planes[j]), glm::dvec3(planes[k])));
        if (std::abs(glm::determinant(normals)) < 1e-12) continue;
        const glm::dvec3 p = glm::inverse(normals) * -glm::dvec3(planes[i].w, planes[j].w, planes[k].w);
        if (inside(p)) corners.push_back(p);
      }
  return corners;
}

void KeyRegion::enclose(std::span<const glm::dvec3> seen, double tan_radius) {
  min = glm::dvec2(std::numeric_limits<double>::infinity());
  max = -min;
  for (const glm::dvec3& p : seen) {
    const glm::dvec2 place(glm::dot(right, p), glm::dot(up, p));
    const double reach = tan_radius * (top - glm::dot(towards, p));
    min = glm::min(min, place - reach);
    max = glm::max(max, place + reach);
  }
}

bool KeyRegion::holds(const KeyRegion& other) const {
  const double doubt = 1e-6 * (max.x - min.x + max.y - min.y);
  return right == other.right && up == other.up && towards == other.towards &&
         glm::all(glm::lessThanEqual(min - doubt, other.min)) &&
         glm::all(glm::greaterThanEqual(max + doubt, other.max)) && top >= other.top - doubt &&
         top - range <= other.top - other.range + doubt;
}

std::optional<KeyRegion> regionOf(std::span<const glm::dvec3> seen, glm::dvec3 towards, double tan_radius,
                                  const scene::Box& casters) {
  if (seen.empty() || casters.empty()) return std::nullopt;
  constexpr int kTurns = 12;  // number of angles tried over a quarter turn
  const glm::dvec3 beside = std::abs(towards.y) < 0.9 ? glm::dvec3(0, 1, 0) : glm::dvec3(1, 0, 0);
  const glm::dvec3 first = glm::normalize(glm::cross(beside, towards)), second = glm::cross(towards, first);
  std::optional<KeyRegion> best;
  double bottom = std::numeric_limits<double>::infinity();
  for (const glm::dvec3& p : seen) bottom = std::min(bottom, glm::dot(towards, p));
  const double top = std::max(extent(casters, towards, /*most=*/true), bottom);
  for (int turn = 0; turn < kTurns; ++turn) {
    const double angle = 0.5 * std::numbers::pi * turn / kTurns;
    KeyRegion region{.right = std::cos(angle) * first + std::sin(angle) * second, .towards = towards};
    region.up = glm::cross(towards, region.right);
    region.top = top;
    region.range = top - bottom;
    region.enclose(seen, tan_radius);
    if (!best || region.area() < 0.999 * best->area()) best = region;
  }
  return best;
}

}  // namespace lambent::frame
