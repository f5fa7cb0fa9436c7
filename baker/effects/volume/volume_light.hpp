// A baked volume as others see it: how much of a ray's light it lets through, and what it scatters along the
// ray towards where the ray starts. For neighborhoods (what a cloud does to the ground below it), and for
// whatever else looks through it.
#pragma once

#include <span>

#include <glm/vec3.hpp>

namespace lambent::baker {

class VolumeLight {
 public:
  virtual ~VolumeLight() = default;
  // Bands of the light that the volume's transfer answers.
  virtual int order() const = 0;
  // Light from the surroundings that comes down the ray from its far end is multiplied by the returned
  // transmittance (0..1); `scattered` receives the radiance that the volume adds, per light coefficient:
  // [channel][order²], orthonormal basis, group frame. Points and directions in the volume's group frame,
  // direction of unit length, from 0 to t_max metres. Deterministic, from any thread.
  virtual float look(const glm::vec3& origin, const glm::vec3& direction, float t_max,
                     std::span<float> scattered) const = 0;
};

}  // namespace lambent::baker
