// Fills a polygon of the plane with triangles for light: a grid of points, finer along the polygon's rim and
// along cuts, where other surfaces meet it. Beside a cut each side has a row of points of its own, so that
// light changes from one row to the other at once.
#pragma once

#include <cstdint>
#include <functional>
#include <optional>
#include <span>
#include <utility>
#include <vector>

#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

// Returns twice the area of the triangle 0, a, b, above 0 if it is counter-clockwise.
inline double cross(const glm::dvec2& a, const glm::dvec2& b) {
  return a.x * b.y - a.y * b.x;
}

struct Line {
  glm::dvec2 a{0.0}, b{0.0};
};

// An outline may have holes and several parts.
struct Outline {
  std::vector<glm::dvec2> points;
  std::vector<std::pair<std::uint32_t, std::uint32_t>> edges;
};

// Lengths are metres.
struct GridRules {
  double inside = 0.0, along = 0.0;  // distances of points inside, and along rims and cuts
  double beside = 0.0;               // of a row from its cut
  // Returns the factor on `inside` and `along` at a point.
  std::function<double(const glm::dvec2&)> scale;
  // Returns the share of pictures that a square metre takes up there. Points are not placed for what is not
  // seen.
  std::function<double(const glm::dvec2&)> seen;
};

struct FaceMesh {
  std::vector<glm::dvec2> points;     // those of the outline first
  std::vector<glm::uvec3> triangles;  // counter-clockwise
};

// Returns nothing if the outline crosses itself or has no edges. Without rules no points are added.
std::optional<FaceMesh> fillOutline(const Outline& outline, std::span<const Line> cuts,
                                    const GridRules* rules);

}  // namespace lambent::baker
