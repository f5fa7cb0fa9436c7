#include "baker/plan/smooth_dielectrics.hpp"

#include <algorithm>

#include <glm/common.hpp>

#include "baker/plan/lobe_energy.hpp"
#include "runtime/bundle/description.hpp"

namespace lambent::baker {

namespace {

// Where five bands carry nine tenths of a highlight, what they leave out does not show.
constexpr int kBands = 5;
constexpr double kCarried = 0.9;

// A layer that reflects more than this straight on is as good as a metal.
constexpr float kMostReflected = 0.1f;

bool hasTextureOfLayer(const gltf::Material& material) {
  return material.specular_texture.texture >= 0 || material.specular_color_texture.texture >= 0;
}

}  // namespace

glm::vec3 reflectedStraightOn(const gltf::Material& material) {
  return material.specular * glm::min(material.reflectance() * material.specular_color, glm::vec3(1.0f));
}

bool isSmoothDielectric(const gltf::Material& material) {
  if (material.isDiffuse() || material.metallic > 0.0f || material.anisotropy > 0.0f) return false;
  if (bundle::brdfFamilyOf(material) != bundle::BrdfFamily::Ggx || hasTextureOfLayer(material)) return false;
  const glm::vec3 f0 = reflectedStraightOn(material);
  if (std::max({f0.r, f0.g, f0.b}) > kMostReflected) return false;
  return lobeEnergyShare(double{material.roughness}, kBands) < kCarried;
}

bool hasMatrices(const gltf::Material& material) {
  return !material.isDiffuse() && !isSmoothDielectric(material);
}

glm::vec3 meanSpecularAlbedo(const gltf::Material& material) {
  // The mean of Schlick's (1 - cos)^5 over diffuse light is ∫ 2 c (1 - c)^5 dc = 1/21.
  constexpr float kMeanEdge = 1.0f / 21.0f;
  return glm::mix(reflectedStraightOn(material), glm::vec3(material.specular), kMeanEdge);
}

glm::vec3 albedoUnderLayer(const glm::vec3& base_color, const glm::vec3& layer) {
  return (1.0f - std::max({layer.r, layer.g, layer.b})) * base_color + layer;
}

glm::vec3 baseUnderLayer(const glm::vec3& albedo, const glm::vec3& layer) {
  const float rest = 1.0f - std::max({layer.r, layer.g, layer.b});
  return rest > 0.0f ? glm::clamp((albedo - layer) / rest, 0.0f, 1.0f) : glm::vec3(0.0f);
}

}  // namespace lambent::baker
