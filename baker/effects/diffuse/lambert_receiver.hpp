// Receives the light of a group's emitters at a diffuse sample: E/pi at its own normal and, if the surface
// has a normal map, the nine values of incident_basis.hpp.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "baker/effects/diffuse/hemisphere.hpp"
#include "baker/trace/emitters.hpp"

namespace lambent::baker {

// LightSums are the columns to which light of one sample is added: values[(output * channels + channel) *
// columns + first_column + k].
struct LightSums {
  std::span<float> scalar;    // one output: E/pi at the sample's normal
  std::span<float> incident;  // nine outputs, local frame; empty for plain samples
  std::uint32_t channels = 1, columns = 0, first_column = 0;

  void add(std::uint32_t light, glm::vec3 radiance, float weight,
           const std::array<float, kIncident>* incident_weights) const;
};

// A LambertReceiver adds up E/pi, and the nine values of normal-mapped samples.
class LambertReceiver : public LightReceiver {
 public:
  LambertReceiver(const Hemisphere& hemisphere, const LightSums& sums)
      : hemisphere_(hemisphere), sums_(sums) {}
  glm::vec3 direction(std::size_t ray) const override { return hemisphere_.direction(ray); }
  float raysPerSteradian(float cosine) const override { return hemisphere_.raysPerSteradian(cosine); }
  void addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) override;
  void addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) override;

 private:
  const Hemisphere& hemisphere_;
  LightSums sums_;
};

}  // namespace lambent::baker
