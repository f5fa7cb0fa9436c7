// The surfaces of a rigid group as patches that send light to each other: the triangles of its capture
// proxy's finest level, split into smaller ones of about the same area. A patch sends out one radiance in all
// directions. Group frame. No GL.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <vector>

#include <glm/vec3.hpp>

#include "runtime/bundle/capture_proxy.hpp"
#include "runtime/lighting/triangle_rays.hpp"

namespace lambent::lighting {

inline constexpr std::size_t kMaxPatches = 1024;
inline constexpr std::size_t kPatchPoints = 4;

// A triangle whose edges are cut into `parts` falls into parts², in rows along the third corner's weight: row
// r has lower and upper triangles in turn.
struct TrianglePart {
  std::uint32_t column = 0, row = 0;
  bool upper = false;
  // Where the second corner has weight b and the third c.
  static TrianglePart at(std::uint32_t parts, float b, float c);
  std::size_t place(std::uint32_t parts) const {
    return std::size_t{row} * (2 * parts - row) + 2 * std::size_t{column} + (upper ? 1 : 0);
  }
};

struct Patch {
  std::array<glm::vec3, kPatchPoints> points{};   // each stands for a quarter of its area
  std::array<glm::vec3, kPatchPoints> origins{};  // where rays from them may start
  glm::vec3 normal{0.0f, 1.0f, 0.0f};
  float area = 0.0f;
  glm::vec3 albedo{0.0f};
};

class Patches {
 public:
  Patches() = default;
  // At least one patch to each triangle of the level, about `most` in all.
  explicit Patches(const bundle::CaptureProxy& proxy, std::size_t most = kMaxPatches);

  const std::vector<Patch>& all() const { return patches_; }
  std::size_t size() const { return patches_.size(); }
  // The triangles that they are parts of, in the order of the proxy.
  const TriangleSet& triangles() const { return triangles_; }
  std::size_t patchAt(const RayHit& hit) const;
  // Those of a triangle, one after the other.
  std::size_t firstOf(std::size_t triangle) const { return split_[triangle].first; }
  std::size_t countOf(std::size_t triangle) const {
    return std::size_t{partsOf(triangle)} * partsOf(triangle);
  }
  // Into how many its edges are cut.
  std::uint32_t partsOf(std::size_t triangle) const { return split_[triangle].parts; }
  // Length of the diagonal of their bounds.
  float extent() const { return extent_; }
  // How far the proxy may lie from the surface that it stands for.
  float error() const { return error_; }
  // A point a little above the surface where rays may start. One of the true surface may lie a little behind
  // the proxy, there or at a wall beside it: then it is brought before it. normal: of the surface there.
  glm::vec3 inFront(glm::vec3 point, const glm::vec3& normal) const;

 private:
  // The edges of a triangle are cut into so many parts, and so is the triangle, squared.
  struct Split {
    std::size_t first = 0;
    std::uint32_t parts = 1;
  };
  // Whether the point, seen along the triangle's normal, is on it or nearer to it than the error.
  bool over(std::size_t triangle, const glm::vec3& point) const;

  std::vector<Patch> patches_;
  std::vector<Split> split_;  // by triangle
  std::vector<std::array<glm::vec3, 3>> corners_;
  std::vector<glm::vec3> normals_;
  TriangleSet triangles_;
  float extent_ = 0.0f, error_ = 0.0f;
};

}  // namespace lambent::lighting
