// The microfacet model of glTF 2.0 (appendix B) and KHR_materials_anisotropy has GGX normals (Walter and
// others 2007), height-correlated Smith shadowing (Heitz 2014), and Schlick's Fresnel term (1994) split into
// the factors of F0 and F90:
//   f = D G2 / (4 v_z s_z) (F0 (1 - w) + F90 w),   w = (1 - v.h)^5.
#include <algorithm>
#include <cmath>
#include <numbers>

#include <glm/geometric.hpp>

#include "baker/brdf/brdf.hpp"

namespace lambent::baker {

namespace {

constexpr double kLeastAlpha = 1e-3;

class Ggx final : public Brdf {
 public:
  explicit Ggx(bool anisotropic) : anisotropic_(anisotropic) {}

  std::uint32_t lobes() const override { return 2; }
  bool isotropic() const override { return !anisotropic_; }
  bool hasRoughness() const override { return true; }

  BrdfFocus focus(const BrdfParameters& at) const override {
    const double roughness = std::clamp(static_cast<double>(at.roughness), 0.0, 1.0);
    const double alpha = std::max(roughness * roughness, kLeastAlpha);
    const double strength = anisotropic_ ? std::clamp(static_cast<double>(at.strength), 0.0, 1.0) : 0.0;
    return {.alpha_t = std::lerp(alpha, 1.0, strength * strength), .alpha_b = alpha, .cosine_share = 0.0};
  }

  void value(const BrdfParameters& at, const glm::dvec3& v, const glm::dvec3& s,
             std::span<double> out) const override {
    const BrdfFocus alpha = focus(at);
    const glm::dvec3 h = glm::normalize(v + s);
    const double x = h.x / alpha.alpha_t, y = h.y / alpha.alpha_b, width = x * x + y * y + h.z * h.z;
    const double d = 1 / (std::numbers::pi * alpha.alpha_t * alpha.alpha_b * width * width);
    // G2 / (4 v_z s_z) = 1 / (2 (s_z |stretched v| + v_z |stretched s|)).
    const auto stretched = [&](const glm::dvec3& w) {
      return glm::length(glm::dvec3(alpha.alpha_t * w.x, alpha.alpha_b * w.y, w.z));
    };
    const double f = 0.5 * d / (s.z * stretched(v) + v.z * stretched(s));
    const double past = 1 - glm::dot(v, h), squared = past * past, fresnel = squared * squared * past;
    out[0] = f * (1 - fresnel);
    out[1] = f * fresnel;
  }

 private:
  bool anisotropic_;
};

}  // namespace

std::unique_ptr<Brdf> makeGgx(bool anisotropic) {
  return std::make_unique<Ggx>(anisotropic);
}

}  // namespace lambent::baker
