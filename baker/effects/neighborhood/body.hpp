// Defines a body as its surroundings see it: how much of the light from beyond it stops, and what light it
// sends itself. Surfaces (surface_body.hpp) and media (volume_body.hpp) are bodies; what uses them
// (point_change.hpp) knows neither. Everything is in the group's frame, with points relative to
// GroupGeometry::origin.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/neighborhood/cap_directions.hpp"

namespace lambent::baker {

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
