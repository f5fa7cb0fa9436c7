// Represents the light at a normal-mapped point for any normal near the surface's own. It is stored as nine
// values l'_j, bands 0..2 of a function whose convolution with the clamped cosine gives E/pi at the pixel's
// normal n':
//   E(n')/pi = sum_j (A_l/pi) y_j(n') l'_j        (Ramamoorthi and Hanrahan 2001).
// There is no light below the horizon, so plain projection onto nine harmonics would smear it. Instead, the
// nine values of a direction s are those for which the sum is nearest to max(n'·s, 0)/pi over normals n'
// around the surface's (least squares with weight cos²), and exact at the surface's own normal. So a flat
// normal map changes nothing.
#pragma once

#include <array>
#include <cstdint>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/direction_table.hpp"

namespace lambent::baker {

inline constexpr std::size_t kIncident = 9;

class IncidentBasis {
 public:
  IncidentBasis();

  // Returns l'_j of unit radiance per steradian from direction s, in the local frame with z the surface's
  // normal and s.z >= 0.
  std::array<float, kIncident> evaluate(glm::vec3 s) const;

 private:
  // The problem is symmetric about z, so it takes one curve over s.z for each (l, |m|).
  static constexpr std::size_t kSteps = 256;
  std::array<std::array<float, 6>, kSteps + 1> curves_;
};

// Projects visibility onto the spherical harmonics of the shared directions. Weights make sums over rays
// exact where the answer is known: with nothing blocked the sum is the closed form (A_l/pi) y_i(n) to float
// rounding, with everything blocked it is 0. Between the two the error is that of the low-discrepancy
// directions alone.

class ProjectionTable {
 public:
  // `base` are the weights that follow from the distribution of the rays, cos/pi over their density, with the
  // sum 1. The order is 1..8.
  ProjectionTable(const DirectionTable& table, std::span<const double> base, int order);

  // Computes shadowed transfer in the local frame from the blocked masks of RayScene::trace; `out` has order²
  // coefficients.
  void project(std::span<const std::uint16_t> blocked, std::span<float> out) const;

  // Returns y_i in the direction of a ray, unweighted.
  std::span<const float> harmonics(std::size_t ray) const {
    return std::span(harmonics_).subspan(ray * columns_, columns_);
  }

  // Returns the weights of the rays: near `base`, all positive, with the sum 1.
  std::span<const double> weights() const { return weights_; }

 private:
  std::span<const float> row(std::size_t ray) const {
    return std::span(rows_).subspan(ray * columns_, columns_);
  }
  std::span<const float> packetSum(std::size_t p) const {
    return std::span(packet_sums_).subspan(p * columns_, columns_);
  }

  std::size_t columns_;
  std::vector<double> weights_;
  std::vector<float> harmonics_;    // y_i of each ray
  std::vector<float> rows_;         // weight * y_i of each ray
  std::vector<float> packet_sums_;  // weight * y_i, summed over the sixteen rays of each packet
  std::vector<float> open_;         // closed form with nothing blocked
};

// Holds the directions of a sample's rays, with everything that depends on the directions alone:
// cosine-distributed for plain samples, uniform for samples of normal-mapped surfaces.

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
