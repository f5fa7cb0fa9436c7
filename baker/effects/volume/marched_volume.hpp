// Defines a baked volume as others see it: how much of a ray's light it lets through, and how much light it
// scatters along the ray towards the ray's origin. Neighborhoods read it (for what a cloud does to the ground
// below it), and so may all else that looks through a volume.
#pragma once

#include <span>

#include <glm/vec3.hpp>

#include "baker/effects/volume/volume.hpp"

namespace lambent::baker {

class VolumeLight {
 public:
  virtual ~VolumeLight() = default;
  // Returns the number of bands of incident light that the volume's transfer covers.
  virtual int order() const = 0;
  // Traces a ray over 0..t_max metres. Returns the transmittance (0..1) by which light from beyond the ray's
  // far end is multiplied. `scattered` receives the radiance that the volume adds, per light coefficient:
  // [channel][order²], orthonormal basis, group frame. Points and directions are in the volume's group frame,
  // and the direction is unit. May be called from any thread; the result is deterministic.
  virtual float look(const glm::vec3& origin, const glm::vec3& direction, float t_max,
                     std::span<float> scattered) const = 0;
};

// Implements VolumeLight by marching through the density with the volume's uncoded transfer.

// look() has three channels. Radiance is the sum over stretches of tau (1 - exp(-depth)) albedo T, where T
// includes all scatterings if they were baked. With more than one band, sum_lm g^l T_lm y_lm(direction) takes
// the place of T.
class MarchedVolume : public VolumeLight {
 public:
  explicit MarchedVolume(VolumeTransfer transfer) : transfer_(std::move(transfer)) {}

  int order() const override { return transfer_.order; }
  float look(const glm::vec3& origin, const glm::vec3& direction, float t_max,
             std::span<float> scattered) const override;

 private:
  VolumeTransfer transfer_;
};

}  // namespace lambent::baker
