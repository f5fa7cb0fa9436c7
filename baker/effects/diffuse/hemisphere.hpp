// The directions in which samples look, with everything that depends on the directions alone: one for plain
// samples (cosine-distributed), one for samples of normal-mapped surfaces (uniform).
#pragma once

#include <array>
#include <optional>
#include <vector>

#include "baker/effects/diffuse/incident_basis.hpp"
#include "baker/effects/diffuse/projection_table.hpp"
#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

class Hemisphere {
 public:
  static Hemisphere forNormal(std::size_t rays, int order);     // E/pi at the sample's own normal
  static Hemisphere forAnyNormal(std::size_t rays, int order);  // and the nine numbers beside it

  const DirectionTable& table() const { return table_; }
  const ProjectionTable& projection() const { return projection_; }
  // What the radiance along a ray adds to E/pi.
  double weight(std::size_t ray) const { return projection_.weights()[ray]; }

  // The same for l'_j; only where hasIncident().
  bool hasIncident() const { return basis_.has_value(); }
  const std::array<float, kIncident>& incidentWeight(std::size_t ray) const { return incident_[ray]; }
  // l'_j of unit radiance per steradian from any direction above the horizon.
  std::array<float, kIncident> incident(glm::vec3 local) const { return basis_->evaluate(local); }

  // Rays per steradian in the direction with this cosine.
  float raysPerSteradian(float cosine) const;
  glm::vec3 direction(std::size_t ray) const { return {table_.x[ray], table_.y[ray], table_.z[ray]}; }

 private:
  Hemisphere(DirectionTable table, const std::vector<double>& base, int order);

  DirectionTable table_;
  ProjectionTable projection_;
  std::optional<IncidentBasis> basis_;
  std::vector<std::array<float, kIncident>> incident_;
};

}  // namespace lambent::baker
