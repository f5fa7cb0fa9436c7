// Implements VolumeLight by marching through the density with the volume's uncoded transfer.
#pragma once

#include "baker/effects/volume/volume_light.hpp"
#include "baker/effects/volume/volume_transfer.hpp"

namespace lambent::baker {

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
