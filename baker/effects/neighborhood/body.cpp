#include "baker/effects/neighborhood/body.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

namespace {

// The cap is a little wider, so that rounding leaves no part of the body out.
constexpr double kWider = 1.0 + 1e-3;

}  // namespace

double Cap::steradians() const {
  return 2.0 * std::numbers::pi * past;
}

Cap capOf(const glm::vec3& point, const glm::vec3& centre, float radius) {
  const glm::dvec3 to = glm::dvec3(centre) - glm::dvec3(point);
  const double distance = glm::length(to), wide = kWider * double{radius};
  if (!(distance > wide)) return {};
  const double sine = wide / distance;
  return {.frame = glm::mat3(localFrame(to / distance)),
          .past = sine * sine / (1.0 + std::sqrt(1.0 - sine * sine))};
}

CapDirections::CapDirections(std::size_t rays) {
  // The table's points have z = 1 - r² under Lambert's equal-area map of the disc.
  const DirectionTable table = uniformTable(rays);
  for (std::size_t r = 0; r < table.size(); ++r) {
    const double stretch = std::sqrt(1.0 + double{table.z[r]});
    disc_.emplace_back(double{table.x[r]} / stretch, double{table.y[r]} / stretch);
  }
}

void CapDirections::packet(std::size_t p, const Cap& cap, DirectionPacket& out) const {
  for (std::size_t k = 0; k < kPacketWidth; ++k) {
    const glm::dvec2 at = disc_[p * kPacketWidth + k];
    // The map from the disc to the cap is equal-area too: 1 - z = r² past, and sin = r sqrt(past (2 - r²
    // past)).
    const double below = glm::dot(at, at) * cap.past;
    const double stretch = std::sqrt(std::max(0.0, cap.past * (2.0 - below)));
    out[k] = cap.frame * glm::vec3(static_cast<float>(stretch * at.x), static_cast<float>(stretch * at.y),
                                   static_cast<float>(1.0 - below));
  }
}

}  // namespace lambent::baker
