// Holds the directions of a sample's rays, with everything that depends on the directions alone:
// cosine-distributed for plain samples, uniform for samples of normal-mapped surfaces.
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
  static Hemisphere forNormal(std::size_t rays, int order);     // for E/pi at the sample's own normal
  static Hemisphere forAnyNormal(std::size_t rays, int order);  // for E/pi and the nine incident values

  const DirectionTable& table() const { return table_; }
  const ProjectionTable& projection() const { return projection_; }
  // Returns how much radiance along a ray adds to E/pi.
  double weight(std::size_t ray) const { return projection_.weights()[ray]; }

  // Returns how much radiance along a ray adds to each l'_j. May be called only if hasIncident().
  bool hasIncident() const { return basis_.has_value(); }
  const std::array<float, kIncident>& incidentWeight(std::size_t ray) const { return incident_[ray]; }
  // Returns l'_j of unit radiance per steradian from any direction above the horizon.
  std::array<float, kIncident> incident(glm::vec3 local) const { return basis_->evaluate(local); }

  // Returns the rays per steradian in a direction with this cosine.
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
