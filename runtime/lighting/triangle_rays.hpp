// Rays among a few hundred triangles, of which many start at the same point. For such a point each triangle
// gives three planes through the point and its edges; a ray hits the triangle that it passes on the same side
// of all three. This takes a few instructions per triangle, eight of them at a time, and beats a tree of
// boxes as long as there are no more than a capture proxy has. No state is shared, any number of threads. No
// GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/vec3.hpp>

namespace lambent::lighting {

struct RayTriangle {
  std::array<glm::vec3, 3> corners{};  // counter-clockwise from the front
  bool front_only = false;             // rays that come from behind pass through it
  bool operator==(const RayTriangle&) const = default;
};

// By coordinate, so that a loop over triangles takes several at a time.
class TriangleSet {
 public:
  void add(const RayTriangle& triangle);
  std::size_t size() const { return count_; }
  RayTriangle operator[](std::size_t index) const;

 private:
  friend class RaysFrom;
  std::array<std::vector<float>, 9> corners_;  // x, y, z of each corner
  std::vector<float> double_area_;
  std::vector<std::int32_t> front_only_;
  std::size_t count_ = 0;
};

struct RayHit {
  std::uint32_t triangle = 0;
  float b = 0.0f, c = 0.0f;  // weights of the second and third corner
  bool back = false;
};

// All rays from one point at a time.
class RaysFrom {
 public:
  // The set must outlive this and stay as it is. Triangles whose plane is nearer to the origin than
  // least_distance are left out: those that the origin lies on.
  RaysFrom(const TriangleSet& set, float least_distance);

  void moveTo(const glm::vec3& origin);
  // For directions within 90 degrees of the normal alone: others may pass through what is there.
  void moveTo(const glm::vec3& origin, const glm::vec3& normal);
  // The nearest triangle along a direction of any length.
  std::optional<RayHit> first(const glm::vec3& direction);
  // Whether anything stands within this many lengths of the direction.
  bool blocked(const glm::vec3& direction, float lengths) const;

 private:
  const TriangleSet& set_;
  float least_distance_;
  // Per triangle that may be hit: normals of the three planes, signed so that they point inwards, and the
  // volume that the origin spans with it.
  std::array<std::vector<float>, 9> planes_;
  std::vector<float> volume_;
  std::vector<std::uint32_t> index_;  // in the set
  std::vector<std::uint8_t> back_;
  std::vector<std::uint32_t> distance_;  // along the last ray, as bits; all bits: not hit
  std::size_t count_ = 0;
};

}  // namespace lambent::lighting
