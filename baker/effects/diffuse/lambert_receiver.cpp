#include "baker/effects/diffuse/lambert_receiver.hpp"

#include <numbers>

namespace lambent::baker {

namespace {

constexpr float kPi = std::numbers::pi_v<float>;

}  // namespace

void LightSums::add(std::uint32_t light, glm::vec3 radiance, float weight,
                    const std::array<float, kIncident>* incident_weights) const {
  for (std::uint32_t c = 0; c < channels; ++c) {
    const float value = radiance[static_cast<int>(c)];
    const std::size_t at = std::size_t{c} * columns + first_column + light;
    scalar[at] += weight * value;
    if (!incident_weights) continue;
    for (std::size_t j = 0; j < kIncident; ++j)
      incident[j * channels * columns + at] += (*incident_weights)[j] * value;
  }
}

void LambertReceiver::addAlong(std::size_t ray, std::uint32_t light, glm::vec3 radiance) {
  sums_.add(light, radiance, static_cast<float>(hemisphere_.weight(ray)),
            hemisphere_.hasIncident() ? &hemisphere_.incidentWeight(ray) : nullptr);
}

void LambertReceiver::addFrom(glm::vec3 local, std::uint32_t light, glm::vec3 radiance) {
  if (hemisphere_.hasIncident()) {
    const auto incident = hemisphere_.incident(local);
    sums_.add(light, radiance, local.z / kPi, &incident);
  } else {
    sums_.add(light, radiance, local.z / kPi, nullptr);
  }
}

}  // namespace lambent::baker
