// Intersects rays with a few hundred triangles, when many rays start at the same point. For such a point each
// triangle gives three planes through the point and its edges, and a ray hits the triangle if it passes all
// three on the same side. This takes a few instructions per triangle, for eight triangles at a time, and is
// faster than a bounding volume hierarchy for the size of a capture proxy. No state is shared, so any number
// of threads may work at once. No GL.
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
  bool front_only = false;             // rays from behind pass through it
  bool operator==(const RayTriangle&) const = default;
};

// Stores triangles by coordinate, so that a loop handles several at a time.
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
  float b = 0.0f, c = 0.0f;  // barycentric weights of the second and third corner
  bool back = false;
};

// Traces rays that start at one point at a time.
class RaysFrom {
 public:
  // The set must outlive this object and stay unchanged. Triangles whose plane is nearer to the origin than
  // least_distance are left out, since the origin lies on them.
  RaysFrom(const TriangleSet& set, float least_distance);

  void moveTo(const glm::vec3& origin);
  // Prepares only for directions within 90 degrees of the normal; other rays may miss triangles.
  void moveTo(const glm::vec3& origin, const glm::vec3& normal);
  // Returns the nearest triangle along a direction of any length.
  std::optional<RayHit> first(const glm::vec3& direction);
  // Returns whether anything is hit within this many lengths of the direction.
  bool blocked(const glm::vec3& direction, float lengths) const;

 private:
  const TriangleSet& set_;
  float least_distance_;
  // Holds, for each triangle that may be hit, the inward normals of the three planes, and the volume that the
  // origin spans with the triangle.
  std::array<std::vector<float>, 9> planes_;
  std::vector<float> volume_;
  std::vector<std::uint32_t> index_;  // index in the set
  std::vector<std::uint8_t> back_;
  std::vector<std::uint32_t> distance_;  // along the last ray, as bits of a float; all bits set: not hit
  std::size_t count_ = 0;
};

}  // namespace lambent::lighting
