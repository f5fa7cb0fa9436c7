// Holds the transfer matrices of the glossy samples of a group, in the group's frame: l' = M l is the light
// that arrives at a sample after shadows and interreflection (Sloan 2002, section 4; Kautz 2002). Direct
// light is stored as visibility V in order_in + order_out - 1 bands, bounced light and light of the group's
// own lights as matrices. Below the sample's tangent plane, where the BRDF reads nothing, transferred light
// continues as its mirror image: V(s) = V(mirrored s), and bounced light alike. So V is 1 at open points and
// 0 in closed rooms, without an edge along the horizon at which few bands would ring.
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

struct GlossyField {
  int order_in = 5, order_out = 5;  // during bounces, order_out is the order of exit radiance
  std::uint32_t channels = 1;       // of bounced light and of the lights: 1 or 3
  std::uint32_t light_columns = 0;  // number of lights of the group
  std::uint32_t first_sample = 0;   // that of SampleSet::glossy

  std::vector<float> visibility;  // [sample][k], visibilityBands()² each
  // Bounced light of the environment: [sample][channel][output][column], order_out² by order_in²; empty
  // without bounces.
  std::vector<float> bounced;
  // Light of the group's lights, without and with bounces: [sample][channel][output][light]; empty if there
  // are none.
  std::vector<float> lights_shadowed, lights_full;

  int visibilityBands() const { return order_in + order_out - 1; }
  std::size_t visibilitySize() const {
    return static_cast<std::size_t>(visibilityBands() * visibilityBands());
  }
  std::size_t size() const { return visibility.size() / visibilitySize(); }
  // Keeps only the first `order` bands, at most order_out, of visibility and lights_shadowed.
  void keepBands(int order);
};

// Holds the directions of a glossy sample's rays, uniform over the hemisphere, with their spherical
// harmonics. Functions continue below the horizon as their mirror image (glossy_transport.hpp), so in the
// sample's frame only harmonics with even l + m are left: n(n+1)/2 of n². They are called "even" here, and
// listed by ascending index, so those of a lower order come first. They are orthogonal over the hemisphere,
// which makes exact weights easy (docs/design/glossy.md, "Visibility").

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
