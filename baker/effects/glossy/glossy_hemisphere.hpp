// Holds the directions of a glossy sample's rays, uniform over the hemisphere, with their spherical
// harmonics. Functions continue below the horizon as their mirror image (glossy_transport.hpp), so in the
// sample's frame only harmonics with even l + m are left: n(n+1)/2 of n². They are called "even" here, and
// listed by ascending index, so those of a lower order come first. They are orthogonal over the hemisphere,
// which makes exact weights easy (docs/design/glossy.md, "Visibility").
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/transport/direction_table.hpp"
#include "baker/transport/panes.hpp"
#include "runtime/sh/rotation.hpp"

namespace lambent::baker {

// Returns the number of even harmonics in so many bands.
constexpr std::size_t evenHarmonicCount(int order) {
  return static_cast<std::size_t>(order * (order + 1) / 2);
}

class GlossyHemisphere {
 public:
  // The weights integrate all harmonics of visibility_bands bands exactly and are positive: with nothing
  // blocked V is 1 and with everything blocked 0, to rounding, and matrices made from V have eigenvalues in
  // [0, 1]. With too few rays for that many bands, they integrate as many bands as they can.
  GlossyHemisphere(std::size_t rays, int visibility_bands, int order_out);

  const DirectionTable& table() const { return table_; }
  glm::vec3 direction(std::size_t ray) const { return {table_.x[ray], table_.y[ray], table_.z[ray]}; }
  float raysPerSteradian() const;
  // Returns the share of the hemisphere that a ray stands for; all shares sum to 1.
  double weight(std::size_t ray) const { return weights_[ray]; }

  std::size_t evenOutputs() const { return even_outputs_; }             // number of even harmonics in l'
  std::span<const std::uint16_t> evenIndices() const { return even_; }  // index of each among all harmonics
  // Returns what unit radiance along a ray and along its mirror image adds: even harmonics times solid angle.
  // They are those of evenIndices(), of which the first evenOutputs() belong to l'.
  std::span<const float> row(std::size_t ray) const {
    return std::span(rows_).subspan(ray * even_.size(), even_.size());
  }
  // Computes the same for any local direction, per steradian; `out` has evenOutputs() values.
  void incident(glm::vec3 local, std::span<float> out) const;

  // Computes V in the local frame, all visibility_bands² coefficients, from the blocked masks of
  // RayScene::trace and the open rays that pass panes. V has no colour, so it gets the mean of what they
  // pass.
  void project(std::span<const std::uint16_t> blocked, std::span<const DimmedRay> dimmed,
               std::span<float> out) const;

 private:
  DirectionTable table_;
  int order_out_;
  std::vector<std::uint16_t> even_;
  std::size_t even_outputs_;
  std::vector<double> weights_;
  std::vector<float> rows_;
  std::vector<float> packet_sums_;
};

// Rows are rows of columns, with `stride` values from row to row.
template <typename Value>
struct Rows {
  std::span<Value> values;
  std::size_t stride;
};

// Rotates even outputs in a sample's frame (rows of `local`) to all outputs in the group's frame (rows of
// `out`), for the first `columns` columns. The order is that of `group_from_local`.
void turnOutputs(const sh::Rotation& group_from_local, std::span<const std::uint16_t> even,
                 std::size_t columns, Rows<const float> local, Rows<float> out);

}  // namespace lambent::baker
