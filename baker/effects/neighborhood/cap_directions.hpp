// Chooses the directions in which a point in free space looks at a body: low-discrepancy and evenly spread
// over the cap of the sphere that the body's bounding sphere fills, or over all of it from within. At any
// distance the body gets all rays, so the relative accuracy of its change is the same everywhere.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

struct Cap {
  glm::mat3 frame{1.0f};  // group_from_local; z is the axis
  double past = 2.0;      // 1 - cos(half angle), 0..2; 2: the whole sphere

  double steradians() const;
};

// Returns the cap that a sphere fills as seen from `point`.
Cap capOf(const glm::vec3& point, const glm::vec3& centre, float radius);

using DirectionPacket = std::array<glm::vec3, kPacketWidth>;

class CapDirections {
 public:
  explicit CapDirections(std::size_t rays);  // the number is rounded up to whole packets

  std::size_t size() const { return disc_.size(); }
  std::size_t packets() const { return disc_.size() / kPacketWidth; }
  // Returns sixteen neighbouring unit directions; pdf = 1 / cap.steradians().
  void packet(std::size_t p, const Cap& cap, DirectionPacket& out) const;

 private:
  std::vector<glm::dvec2> disc_;  // points in the unit disc, along a Hilbert curve
};

}  // namespace lambent::baker
