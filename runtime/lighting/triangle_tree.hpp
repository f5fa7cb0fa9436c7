// Intersects rays with the triangles of capture proxies and patches, up to a few thousand. It is a bounding
// volume hierarchy whose leaves hold eight triangles, which a loop tests together. Each ray meets the planes
// through its origin and a triangle's edges, so rays do not slip between triangles that share an edge.
// Nothing changes after construction, so any number of threads may ask at once. No GL.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <vector>

#include <glm/mat4x4.hpp>
#include <glm/vec3.hpp>

#include "runtime/bundle/capture_proxy.hpp"

namespace lambent::lighting {

struct RayTriangle {
  std::array<glm::vec3, 3> corners{};  // counter-clockwise from the front
  bool front_only = false;             // rays from behind pass through it
  bool operator==(const RayTriangle&) const = default;
};

// Appends the triangles of a proxy's level that blocks light, placed by the matrix.
inline void appendBlockers(const bundle::CaptureProxy& proxy, const glm::mat4& place,
                           std::vector<RayTriangle>& triangles) {
  constexpr std::size_t kBlockerLevel = 1;
  if (proxy.levels.empty()) return;
  const bundle::ProxyLevel& level = proxy.levels[std::min(kBlockerLevel, proxy.levels.size() - 1)];
  for (std::uint32_t t = 0; t < level.triangle_count; ++t) {
    const bundle::ProxyTriangle& from = proxy.triangles[level.first_triangle + t];
    RayTriangle& triangle = triangles.emplace_back();
    triangle.front_only = from.front_only;
    for (std::size_t k = 0; k < 3; ++k)
      triangle.corners[k] = glm::vec3(place * glm::vec4(proxy.positions[from.vertices[k]], 1.0f));
  }
}

struct RayHit {
  std::uint32_t triangle = 0;
  float b = 0.0f, c = 0.0f;  // barycentric weights of the second and third corner
  bool back = false;
};

class TriangleTree {
 public:
  TriangleTree() = default;
  // Triangles whose plane is nearer to a ray's origin than least_distance are left out for this ray, since
  // the origin lies on them.
  TriangleTree(std::vector<RayTriangle> triangles, float least_distance);

  std::size_t size() const { return triangles_.size(); }
  const RayTriangle& operator[](std::size_t index) const { return triangles_[index]; }
  const std::vector<RayTriangle>& triangles() const { return triangles_; }
  float leastDistance() const { return least_distance_; }

  // Returns the nearest triangle along a direction of any length. If both sides of something without
  // thickness are hit, the one that faces the ray counts.
  std::optional<RayHit> first(const glm::vec3& origin, const glm::vec3& direction) const;
  // Returns whether anything is hit within this many lengths of the direction.
  bool blocked(const glm::vec3& origin, const glm::vec3& direction, float lengths) const;
  // Sets `found` to the triangles whose bounds are at most this far from the point along each axis, in their
  // order.
  void findNear(const glm::vec3& point, float distance, std::vector<std::uint32_t>& found) const;

 private:
  static constexpr std::size_t kWidth = 8;
  struct Leaf {  // by coordinate; places without a triangle have no area
    std::array<std::array<float, kWidth>, 9> corners{};
    std::array<float, kWidth> double_area{};
    std::array<std::uint32_t, kWidth> front_only{};
    std::array<std::uint32_t, kWidth> index{};
    std::uint32_t count = 0;
  };
  struct Node {
    glm::vec3 low{0.0f}, high{0.0f};
    std::uint32_t place = 0;  // of the leaf, or of the first of two children
    bool leaf = false;
  };
  struct Met {                                     // per triangle of a leaf
    std::array<std::uint32_t, kWidth> distance{};  // bits of a float in lengths of the ray; all set: missed
    std::array<std::uint32_t, kWidth> back{};
  };
  void divide(std::size_t node, std::vector<std::uint32_t>& order, std::size_t begin, std::size_t end);
  Met meet(const Leaf& leaf, const glm::vec3& origin, const glm::vec3& direction) const;
  // Calls visit(leaf) for the leaves that the ray reaches within `lengths`, nearer ones first; visit returns
  // how many lengths of the ray are still of interest.
  template <typename Visit>
  void follow(const glm::vec3& origin, const glm::vec3& direction, float lengths, const Visit& visit) const;

  std::vector<RayTriangle> triangles_;
  std::vector<Node> nodes_;
  std::vector<Leaf> leaves_;
  float least_distance_ = 0.0f;
};

}  // namespace lambent::lighting
