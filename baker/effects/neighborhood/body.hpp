// A body as its surroundings see it: how much of the light from beyond it stops, and what light it sends
// itself. Surfaces (surface_body.hpp) and media (volume_body.hpp) are bodies; what is done with the answers
// (point_change.hpp) knows of neither. Group frame; points from GroupGeometry::origin.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

#include <glm/vec3.hpp>

#include "baker/effects/neighborhood/cap_directions.hpp"

namespace lambent::baker {

// Along sixteen rays from one point.
struct BodyLook {
  std::array<float, kPacketWidth> stopped{};  // share of the light from beyond that does not arrive
  std::uint16_t sends = 0;                    // bit k: the body sends light along ray k
  std::uint16_t backs = 0;                    // bit k: ray k met the back of a single-sided surface first
  // The nearest of those: how far, where, and the normal of its front.
  float nearest_back = std::numeric_limits<float>::infinity();
  glm::vec3 nearest_point{0.0f}, nearest_normal{0.0f};
  // Radiance towards the point per coefficient of the light: [ray][channel][order²]; of rays that send.
  std::vector<float> sent;
};

class Body {
 public:
  virtual ~Body() = default;
  virtual int order() const = 0;               // bands of the light
  virtual std::uint32_t channels() const = 0;  // of what it sends: 0 (it sends nothing), 1 (no colour) or 3
  virtual glm::vec3 centre() const = 0;        // of a sphere about it
  virtual float radius() const = 0;            // metres
  // first_ray: number of the first ray in its table; random choices follow it. with_light: `sent` is wanted;
  // it has room for all sixteen. From any thread, the same whatever the order of calls.
  virtual void look(const glm::vec3& from, const DirectionPacket& along, std::size_t first_ray,
                    bool with_light, BodyLook& out) const = 0;
};

}  // namespace lambent::baker
