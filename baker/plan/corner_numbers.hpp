// Numbers the corners of a mesh by place, so that its triangles tell which of them meet. Vertices at seams of
// texture coordinates and normals, and at the poles of spheres, stand at one place but for rounding.
#pragma once

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>
#include <vector>

#include <glm/geometric.hpp>
#include <glm/vec3.hpp>

namespace lambent::baker {

// Corners nearer to each other than this share of a mesh's diagonal are one corner.
inline constexpr double kSameCorner = 1e-5;

class CornerNumbers {
 public:
  // `tolerance` is greater than 0 and finite.
  explicit CornerNumbers(double tolerance) : tolerance_(tolerance) {}

  // Returns the number of an earlier place that is as near as the tolerance, else a new one.
  std::uint32_t numberOf(const glm::vec3& place) {
    const Cell at = cellOf(place);
    for (std::int64_t x = at.x - 1; x <= at.x + 1; ++x)
      for (std::int64_t y = at.y - 1; y <= at.y + 1; ++y)
        for (std::int64_t z = at.z - 1; z <= at.z + 1; ++z)
          if (const auto found = cells_.find({x, y, z});
              found != cells_.end() &&
              glm::distance(glm::dvec3(places_[found->second]), glm::dvec3(place)) <= tolerance_)
            return found->second;
    places_.push_back(place);
    return cells_[at] = static_cast<std::uint32_t>(places_.size() - 1);
  }

  // Returns the places by their numbers.
  const std::vector<glm::vec3>& places() const { return places_; }

 private:
  struct Cell {
    std::int64_t x = 0, y = 0, z = 0;
    bool operator==(const Cell&) const = default;
  };
  struct CellHash {
    std::size_t operator()(const Cell& cell) const {
      std::uint64_t hash = 0;
      for (const std::int64_t part : {cell.x, cell.y, cell.z})
        hash = (hash ^ static_cast<std::uint64_t>(part)) * 0x9e3779b97f4a7c15ull, hash ^= hash >> 29;
      return static_cast<std::size_t>(hash);
    }
  };
  Cell cellOf(const glm::vec3& place) const {
    const auto cell = [&](int axis) {
      return static_cast<std::int64_t>(std::floor(double{place[axis]} / tolerance_));
    };
    return {cell(0), cell(1), cell(2)};
  }

  double tolerance_;
  std::vector<glm::vec3> places_;
  std::unordered_map<Cell, std::uint32_t, CellHash> cells_;
};

}  // namespace lambent::baker
