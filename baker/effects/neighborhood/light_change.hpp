// Computes how a body changes the light at a point in free space: M - I, without normal or cosine (Sloan,
// Kautz, Snyder 2002, section 6). It has two parts, as in the bundle:
//   visibility: V - 1 in order + order_out - 1 bands, from which the shadow follows without loss,
//               (M - I)_ij = Σ_k Γ_ijk (V - 1)_k (runtime/sh/gaunt.hpp);
//   bounced:    B_ij = ∫ y_i(s) r_j(s) ds, where r_j is the radiance that the body sends towards the point
//               from direction s, under light y_j.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <span>
#include <vector>

#include <glm/mat3x3.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/compress/cpca.hpp"
#include "baker/effects/neighborhood/grid_placement.hpp"
#include "baker/jobs/bake_context.hpp"
#include "baker/transport/samples.hpp"
#include "runtime/sh/gaunt.hpp"

namespace lambent::baker {

// Chooses the directions in which a point in free space looks at a body: low-discrepancy and evenly spread
// over the cap of the sphere that the body's bounding sphere fills, or over all of it from within. At any
// distance the body gets all rays, so the relative accuracy of its change is the same everywhere.

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

// Defines a body as its surroundings see it: how much of the light from beyond it stops, and what light it
// sends itself. Surfaces and media (bodies.hpp) are bodies; what uses them here knows neither.
// Everything is in the group's frame, with points relative to
// GroupGeometry::origin.

// A BodyLook is what sixteen rays from one point see.
struct BodyLook {
  std::array<float, kPacketWidth> stopped{};  // share of the light from beyond that is stopped
  std::uint16_t sends = 0;                    // bit k: the body sends light along ray k
  std::uint16_t backs = 0;                    // bit k: ray k hit the back of a single-sided surface first
  // The nearest of those hits: its distance, its position, and the normal of the surface's front.
  float nearest_back = std::numeric_limits<float>::infinity();
  glm::vec3 nearest_point{0.0f}, nearest_normal{0.0f};
  // Radiance towards the point per coefficient of the light, [ray][channel][order²]; valid for rays that
  // send.
  std::vector<float> sent;
};

class Body {
 public:
  virtual ~Body() = default;
  virtual int order() const = 0;               // bands of incident light
  virtual std::uint32_t channels() const = 0;  // of the light it sends: 0 (it sends none), 1 (grey) or 3
  virtual glm::vec3 centre() const = 0;        // of a bounding sphere
  virtual float radius() const = 0;            // of that sphere, metres
  // Traces sixteen rays. `first_ray` is the number of the first ray in its table, from which random choices
  // follow. `with_light` asks for `sent`, which must have room for all sixteen rays. May be called from any
  // thread; the result does not depend on the order of calls.
  virtual void look(const glm::vec3& from, const DirectionPacket& along, std::size_t first_ray,
                    bool with_light, BodyLook& out) const = 0;
};

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
  sh::GauntTable gaunt_;
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
