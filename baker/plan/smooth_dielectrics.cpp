#include "baker/plan/smooth_dielectrics.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>
#include <vector>

#include <glm/common.hpp>

#include "runtime/bundle/description.hpp"
#include "runtime/sh/zonal.hpp"

namespace lambent::baker {

double lobeEnergyShare(double roughness, int order) {
  const double alpha = std::max(roughness * roughness, 1e-3), a2 = alpha * alpha;
  // Seen along the normal the lobe is zonal, and the half vector is at half the angle. Steps are even in
  // x = atan(tan(theta/2) / alpha), in which the lobe is smooth however narrow it is.
  constexpr int kAngleSteps = 2000;
  std::vector<double> zonal(static_cast<std::size_t>(order), 0.0);
  double all = 0.0;
  const double last = std::atan(1.0 / alpha);  // theta = 90 degrees
  for (int i = 0; i < kAngleSteps; ++i) {
    const double x = (i + 0.5) / kAngleSteps * last;
    const double tan_half = alpha * std::tan(x);
    const double cos_h2 = 1.0 / (1.0 + tan_half * tan_half);
    const double cosine = 2.0 * cos_h2 - 1.0, sine = 2.0 * tan_half * cos_h2;
    const double slope = 2.0 * cos_h2 * alpha / (std::cos(x) * std::cos(x));  // d theta / d x
    const double weight = 2.0 * std::numbers::pi * sine * slope * last / kAngleSteps;
    // The value is D G2 / (4 n.v n.l) times n.l at n.v = 1, up to a constant factor; G2 is the
    // height-correlated Smith term.
    const double bottom = cos_h2 * (a2 - 1.0) + 1.0;
    const double d = 1.0 / (bottom * bottom);
    const double value = d * cosine / (cosine + std::sqrt(a2 + (1.0 - a2) * cosine * cosine));
    all += weight * value * value;
    for (int l = 0; l < order; ++l)
      zonal[static_cast<std::size_t>(l)] +=
          weight * value * sh::legendre(l, cosine) * std::sqrt((2 * l + 1) / (4.0 * std::numbers::pi));
  }
  double carried = 0.0;
  for (const double z : zonal) carried += z * z;
  return carried / all;
}

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
