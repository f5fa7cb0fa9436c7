// Chooses the directions in which a point in free space looks at a body: low-discrepancy and evenly spread
// over the cap of the sphere that the body's bounding sphere fills, or over all of it from within. At any
// distance the body gets all rays, so the relative accuracy of its change is the same everywhere.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
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

// Defines a body as its surroundings see it: how much of the light from beyond it stops, and what light it
// sends itself. Surfaces (bodies.hpp) and media (bodies.hpp) are bodies; what uses them
// (light_change.hpp) knows neither. Everything is in the group's frame, with points relative to
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

}  // namespace lambent::baker
