// Computes how a body changes the light at a point in free space: M - I, without normal or cosine (Sloan,
// Kautz, Snyder 2002, section 6). It has two parts, as in the bundle:
//   visibility: V - 1 in order + order_out - 1 bands, from which the shadow follows without loss,
//               (M - I)_ij = Σ_k Γ_ijk (V - 1)_k (runtime/sh/gaunt.hpp);
//   bounced:    B_ij = ∫ y_i(s) r_j(s) ds, where r_j is the radiance that the body sends towards the point
//               from direction s, under light y_j.
#pragma once

#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/compress/light_weights.hpp"
#include "baker/effects/neighborhood/body.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/bake_context.hpp"

namespace lambent::baker {

// Bands of the change that diffuse receivers read.
inline constexpr int kDiffuseBands = 3;

struct ChangeShape {
  int order = 5, order_out = 3;
  std::uint32_t channels = 0;  // of the bounced part: 0 (there is none), 1 or 3

  std::size_t columns() const { return static_cast<std::size_t>(order * order); }
  std::size_t outputs() const { return static_cast<std::size_t>(order_out * order_out); }
  int visibilityBands() const { return order + order_out - 1; }
  std::size_t visibilitySize() const {
    return static_cast<std::size_t>(visibilityBands() * visibilityBands());
  }
  std::size_t bouncedSize() const { return channels * outputs() * columns(); }  // [channel][output][column]
};

// One object serves one thread.
class PointChange {
 public:
  // Body and directions must outlive this. shape.channels is 0 or the body's.
  PointChange(const Body& body, const CapDirections& directions, const ChangeShape& shape);

  void look(const glm::vec3& point);

  std::span<const float> visibility() const { return visibility_; }
  std::span<const float> bounced() const { return bounced_; }
  // Returns whether the point lies inside the body: more than half of all directions show backs of surfaces.
  bool inside() const;
  // Return the nearest back that was hit and the normal of its front, for points inside.
  const glm::vec3& nearestPoint() const { return nearest_point_; }
  const glm::vec3& nearestNormal() const { return nearest_normal_; }

 private:
  void addVisibility();
  void addBounced();

  const Body& body_;
  const CapDirections& directions_;
  ChangeShape shape_;
  Cap cap_;
  double weight_ = 0.0;  // steradians per ray
  DirectionPacket along_{};
  BodyLook look_;
  std::vector<float> harmonics_;             // [coefficient][ray], for one packet
  std::vector<float> visibility_, bounced_;  // see the functions of these names
  std::vector<float> sums_;                  // [output][channel * columns]
  double backs_ = 0.0;                       // solid angle of hits on backs, steradians
  float nearest_back_ = std::numeric_limits<float>::infinity();
  glm::vec3 nearest_point_{0.0f}, nearest_normal_{0.0f};
};

// Returns how much errors of transferred light show at a receiver, per coefficient of each band: (A_l/pi)² at
// a plain diffuse receiver. A receiver with transfer of its own applies it to all bands; there it is the
// power of a transfer vector for which a wall hides half of the sky.
const BandPower& receiverPower(const ChangeShape& shape);

// A ChangeMeter measures what real lights and a diffuse receiver make of a change: the change of irradiance
// relative to the irradiance without the body. It is the RMS over lights with the band power of real ones at
// any rotation, over normals, and over red, green and blue.
class ChangeMeter {
 public:
  explicit ChangeMeter(const ChangeShape& shape);

  // `bounced` may be empty. May be called from any thread.
  double measure(std::span<const float> visibility, std::span<const float> bounced) const;
  // Returns Σ_ij W_ij I_ij² over red, green and blue, which codeTransfer takes as the energy of one point's
  // light.
  double lightEnergy() const;

 private:
  ChangeShape shape_;
  struct Term {
    std::uint32_t at;  // output * columns + column
    std::uint16_t k;
    float value;
  };
  std::vector<Term> terms_;
  std::vector<float> weights_;  // [output][column]
  double light_ = 0.0;
};

// Computes how a body changes the light at all points of a grid. Points inside the body take values that
// continue the values outside through the surface: twice the value on the surface, less the value as far in
// front of it as the point lies behind it. So interpolation between the last point outside and the first one
// inside is right where it meets the surface: darkness does not bleed, and no halo surrounds the body. Points
// deeper inside take the mean of their neighbours.

struct GridChange {
  ChangeShape shape;
  std::vector<float> visibility, bounced;  // [point], each as in PointChange
  std::vector<std::uint8_t> outside;       // 1 per point, or 0 if its values were continued
  std::uint64_t rays = 0;  // from the points, traced in this run; rays of paths are not counted
  std::uint64_t rays_kept = 0;

  std::size_t insidePoints() const;
};

// Returns nothing if stopped. The result does not depend on the number of threads.
std::optional<GridChange> changeOnGrid(const Body& body, const GridPlacement& grid, const ChangeShape& shape,
                                       std::size_t rays, const BakeContext& context);
// Removes what changeOnGrid() kept.
void dropChange(const BakeContext& context, std::size_t points);

}  // namespace lambent::baker
