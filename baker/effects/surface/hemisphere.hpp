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
#include <utility>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/panes.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/rotation.hpp"

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

// Rows are rows of columns, with `stride` values from row to row.
template <typename Value>
struct Rows {
  std::span<Value> values;
  std::size_t stride;
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
  const std::vector<double>& weights() const { return weights_; }

 private:
  std::size_t columns_;
  std::vector<double> weights_;
  std::vector<float> harmonics_;    // y_i of each ray
  std::vector<float> rows_;         // weight * y_i of each ray
  std::vector<float> packet_sums_;  // weight * y_i, summed over the sixteen rays of each packet
  std::vector<float> open_;         // closed form with nothing blocked
};

// Holds the directions of a sample's rays, and what radiance along each of them adds to the sample's outputs:
// all in which surfaces differ as receivers. The outputs are in the sample's frame.
//   diffuse        E/pi at the sample's normal; rays are distributed by the cosine
//   normal-mapped  E/pi, and the nine values l'_j; rays are uniform over the hemisphere
//   glossy         l' of any direction; rays are uniform. Below the horizon, where the BRDF reads nothing, it
//                  continues as its mirror image (direct.hpp), so only harmonics with even l + m are
//                  left: n(n+1)/2 of n². They are called "even" here, and listed by ascending index, so those
//                  of a lower order come first. They are orthogonal over the hemisphere, which makes exact
//                  weights easy (docs/design/glossy.md, "Visibility").

class Hemisphere {
 public:
  static Hemisphere forNormal(std::size_t rays, int order);
  static Hemisphere forAnyNormal(std::size_t rays, int order);
  // The weights integrate all harmonics of visibility_bands bands exactly and are positive: with nothing
  // blocked V is 1 and with everything blocked 0, to rounding, and matrices made from V have eigenvalues in
  // [0, 1]. With too few rays for that many bands, they integrate as many bands as they can.
  static Hemisphere forBrdfs(std::size_t rays, int visibility_bands, int order_out);

  const DirectionTable& table() const { return table_; }
  glm::vec3 direction(std::size_t ray) const { return {table_.x[ray], table_.y[ray], table_.z[ray]}; }
  // Returns the share of the hemisphere that a ray stands for (of the cosine-weighted one, but for glossy
  // samples); all shares sum to 1.
  double weight(std::size_t ray) const { return weights_[ray]; }
  // Returns how much radiance along a ray adds to E/pi. Over the uniform hemisphere, the cosine has the mean
  // 1/2.
  float irradianceWeight(std::size_t ray) const {
    const auto share = static_cast<float>(weights_[ray]);
    return glossy() ? 2.0f * table_.z[ray] * share : share;
  }
  // Returns the rays per steradian in a direction with this cosine.
  float raysPerSteradian(float cosine) const;

  std::size_t outputs() const { return outputs_; }
  // Returns what unit radiance along a ray adds to the outputs.
  std::span<const float> row(std::size_t ray) const { return wholeRow(ray).first(outputs_); }
  // Computes the same for any local direction above the horizon, per steradian.
  void incident(glm::vec3 local, std::span<float> out) const;
  // Rotates outputs in the sample's frame (rows of `local`) to all harmonics in the group's frame (rows of
  // `out`), for the first `columns` columns: those of glossy samples, or the nine of normal-mapped ones.
  void turn(const sh::Rotation& group_from_local, std::size_t columns, Rows<const float> local,
            Rows<float> out) const;

  // Projects what diffuse and normal-mapped samples see.
  const ProjectionTable& projection() const { return *projection_; }
  // Computes V of glossy samples in the local frame, all visibility_bands² coefficients, from the blocked
  // masks of RayScene::trace and the open rays that pass panes. V has no colour, so it gets the mean of what
  // they pass.
  void projectVisibility(std::span<const std::uint16_t> blocked, std::span<const DimmedRay> dimmed,
                         std::span<float> out) const;

 private:
  explicit Hemisphere(DirectionTable table) : table_(std::move(table)) {}
  bool glossy() const { return !projection_; }
  std::span<const float> wholeRow(std::size_t ray) const {
    return std::span(rows_).subspan(ray * row_size_, row_size_);
  }

  DirectionTable table_;
  std::vector<double> weights_;
  std::size_t outputs_ = 1, row_size_ = 1;
  std::vector<float> rows_;             // of glossy samples: in all even harmonics of V
  std::vector<std::uint16_t> indices_;  // index of each output that is turned among all harmonics
  std::optional<ProjectionTable> projection_;
  std::optional<IncidentBasis> basis_;  // of normal-mapped samples
  std::vector<float> packet_sums_;      // of glossy samples: rows, summed over the rays of each packet
  int order_out_ = 0;
};

}  // namespace lambent::baker
