#include "baker/brdf/layer_albedo.hpp"

#include <algorithm>

#include <glm/common.hpp>
#include <glm/vec3.hpp>

#include "baker/plan/smooth_dielectrics.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

LayerAlbedo::LayerAlbedo(const bundle::BrdfTable& table, const gltf::Material& material) {
  const glm::vec3 f0 = reflectedStraightOn(material);
  std::array<float, bundle::kMaxBrdfLobes * sh::kMaxFactoredOrder * sh::kMaxFactoredOrder> weights;
  for (std::size_t i = 0; i < kCosines; ++i) {
    const float cosine = static_cast<float>(i) / static_cast<float>(kCosines - 1);
    lookUpStored(table, {std::max(cosine, bundle::kLeastViewCosine), 1.0f, 0.0f},
                 std::clamp(material.roughness, 0.0f, 1.0f), 0.0f, weights);
    const glm::vec3 reflected = f0 * weights[0] + material.specular * weights[table.coefficients()];
    albedos_[i] = std::clamp(std::max({reflected.r, reflected.g, reflected.b}), 0.0f, 1.0f);
  }
}

float LayerAlbedo::towards(float cosine) const {
  const float at = std::clamp(cosine, 0.0f, 1.0f) * static_cast<float>(kCosines - 1);
  const auto below = std::min(static_cast<std::size_t>(at), kCosines - 2);
  return glm::mix(albedos_[below], albedos_[below + 1], at - static_cast<float>(below));
}

}  // namespace lambent::baker
