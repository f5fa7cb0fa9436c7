#include <algorithm>
#include <array>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <numbers>
#include <stop_token>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>

#include "baker/brdf/brdf.hpp"
#include "baker/brdf/surface_brdfs.hpp"
#include "baker/import/measured_brdf.hpp"
#include "baker/jobs/parallel.hpp"

namespace lambent::baker {

// The microfacet model of glTF 2.0 (appendix B) and KHR_materials_anisotropy has GGX normals (Walter and
// others 2007), height-correlated Smith shadowing (Heitz 2014), and Schlick's Fresnel term (1994) split into
// the factors of F0 and F90:
//   f = D G2 / (4 v_z s_z) (F0 (1 - w) + F90 w),   w = (1 - v.h)^5.

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

// Interpolates isotropic measurements at scattered directions over half vector and difference
// (docs/conventions.md, "Materials"): a weighted mean over (theta_h, theta_d), after Romeiro, Vasilyev and
// Zickler 2008, tabulated once. Its coordinates make it reciprocal, and it stays so when it is scaled down
// where it would reflect more than it receives.

namespace {

constexpr std::size_t kFewest = 8;  // measurements without which a BRDF is refused
constexpr double kSharpness = 400;  // 1 / (2 sigma²) of the weights
constexpr std::size_t kHalves = 257, kDifferences = 129;
constexpr std::size_t kScaleNodes = 65;
constexpr std::size_t kScaleDirections = 8192;

// Returns (sqrt(2 theta_h / pi), 2 theta_d / pi). It uses arc tangents, since the arc cosine loses all digits
// near 0.
glm::dvec2 placeOf(const glm::dvec3& v, const glm::dvec3& s) {
  const glm::dvec3 sum = v + s;
  const double half = std::atan2(std::hypot(sum.x, sum.y), sum.z);
  const double difference = std::atan2(glm::length(v - s), glm::length(sum));
  return {std::sqrt(std::clamp(half * 2 * std::numbers::inv_pi, 0.0, 1.0)),
          std::clamp(difference * 2 * std::numbers::inv_pi, 0.0, 1.0)};
}

glm::dvec3 directionOf(double theta, double phi) {
  return {std::sin(theta) * std::cos(phi), std::sin(theta) * std::sin(phi), std::cos(theta)};
}

struct Between {
  std::size_t first;
  double share;  // weight of the node after `first`
};

Between between(double unit, std::size_t nodes) {
  const double at = std::clamp(unit, 0.0, 1.0) * static_cast<double>(nodes - 1);
  const std::size_t first = std::min(static_cast<std::size_t>(at), nodes - 2);
  return {first, at - static_cast<double>(first)};
}

class Measured final : public Brdf {
 public:
  explicit Measured(const MeasuredBrdf& measured) {
    tabulate(measured);
    findFocus();
    std::vector<double> scales(kScaleNodes);
    parallelRanges(kScaleNodes, 1, std::stop_token{}, [&](std::size_t begin, std::size_t end) {
      for (std::size_t node = begin; node < end; ++node) {
        const double root = static_cast<double>(node) / (kScaleNodes - 1);
        std::array<double, 3> b{};  // computed while all scales are still 1
        integrateView(*this, {}, {.cos_theta = static_cast<float>(root * root)}, 1, kScaleDirections, b);
        const double albedo = 2 * std::sqrt(std::numbers::pi) * *std::max_element(b.begin(), b.end());
        scales[node] = albedo > 1 ? 1 / albedo : 1.0;
      }
    });
    scales_ = std::move(scales);
  }

  std::uint32_t lobes() const override { return 3; }
  bool isotropic() const override { return true; }
  bool hasRoughness() const override { return false; }
  BrdfFocus focus(const BrdfParameters&) const override {
    return {.alpha_t = alpha_, .alpha_b = alpha_, .cosine_share = 0.5};
  }

  void value(const BrdfParameters&, const glm::dvec3& v, const glm::dvec3& s,
             std::span<double> out) const override {
    const glm::dvec3 f = unscaled(placeOf(v, s)) * std::min(scale(v.z), scale(s.z));
    for (int c = 0; c < 3; ++c) out[static_cast<std::size_t>(c)] = f[c];
  }

 private:
  void tabulate(const MeasuredBrdf& measured) {
    std::vector<glm::dvec2> places;
    std::vector<glm::dvec3> values;
    for (const BrdfMeasurement& m : measured.measurements) {
      places.push_back(placeOf(directionOf(m.theta_i, m.phi_i), directionOf(m.theta_o, m.phi_o)));
      values.push_back(glm::dvec3(m.value));
    }
    table_.resize(kHalves * kDifferences);
    parallelRanges(kDifferences, 1, std::stop_token{}, [&](std::size_t begin, std::size_t end) {
      std::vector<double> distances(places.size());
      for (std::size_t d = begin; d < end; ++d)
        for (std::size_t h = 0; h < kHalves; ++h) {
          const glm::dvec2 place(static_cast<double>(h) / (kHalves - 1),
                                 static_cast<double>(d) / (kDifferences - 1));
          for (std::size_t i = 0; i < places.size(); ++i)
            distances[i] = glm::dot(places[i] - place, places[i] - place);
          // Weights are relative to that of the nearest measurement; otherwise all would vanish far from
          // them.
          const double nearest = *std::min_element(distances.begin(), distances.end());
          glm::dvec3 sum(0.0);
          double weights = 0;
          for (std::size_t i = 0; i < places.size(); ++i) {
            const double exponent = kSharpness * (distances[i] - nearest);
            if (exponent > 40) continue;
            const double weight = std::exp(-exponent);
            weights += weight;
            sum += weight * values[i];
          }
          table_[d * kHalves + h] = glm::max(sum / weights, glm::dvec3(0.0));
        }
    });
  }

  // Finds where the highlight at theta_d = 30 degrees has fallen to half; GGX falls to half at tan(theta_h) =
  // 0.644 alpha.
  void findFocus() {
    const auto largest = [&](std::size_t h) {
      const glm::dvec3& f = table_[kDifferences / 3 * kHalves + h];
      return std::max({f.r, f.g, f.b});
    };
    const double half = 0.5 * (largest(0) + largest(kHalves * 4 / 5));
    std::size_t h = 1;
    while (h + 1 < kHalves && largest(h) > half) ++h;
    const double root = static_cast<double>(h) / (kHalves - 1);
    alpha_ = std::clamp(std::tan(std::min(std::numbers::pi / 2 * root * root, 1.2)) / 0.644, 0.02, 1.0);
  }

  glm::dvec3 unscaled(const glm::dvec2& place) const {
    const Between h = between(place.x, kHalves), d = between(place.y, kDifferences);
    const glm::dvec3* at = &table_[d.first * kHalves + h.first];
    return glm::mix(glm::mix(at[0], at[1], h.share), glm::mix(at[kHalves], at[kHalves + 1], h.share),
                    d.share);
  }

  double scale(double cosine) const {
    if (scales_.empty()) return 1;
    const Between at = between(std::sqrt(std::max(cosine, 0.0)), kScaleNodes);
    return std::lerp(scales_[at.first], scales_[at.first + 1], at.share);
  }

  std::vector<glm::dvec3> table_;  // [theta_d][sqrt(theta_h)]
  std::vector<double> scales_;     // by sqrt(cos)
  double alpha_ = 1.0;
};

}  // namespace

Result<std::unique_ptr<Brdf>> makeMeasured(const MeasuredBrdf& measured) {
  if (measured.measurements.size() < kFewest)
    return fail(measured.name, "has too few measured directions to interpolate between",
                "give a whole measurement");
  return std::make_unique<Measured>(measured);
}

namespace {

using bundle::BrdfFamily;
using gltf::Material;

// The first row that serves a material is used; the last one serves all that are left.
constexpr std::array kKinds = {
    BrdfKind{"measured", BrdfFamily::Measured, [](const Material& m) { return m.brdf >= 0; },
             [](const Scene& scene, const Material& m) {
               return makeMeasured(scene.brdfs[static_cast<std::size_t>(m.brdf)]);
             }},
    BrdfKind{"anisotropic", BrdfFamily::AnisotropicGgx, [](const Material& m) { return m.anisotropy > 0.0f; },
             [](const Scene&, const Material&) -> Result<std::unique_ptr<Brdf>> { return makeGgx(true); }},
    BrdfKind{"round", BrdfFamily::Ggx, [](const Material&) { return true; },
             [](const Scene&, const Material&) -> Result<std::unique_ptr<Brdf>> { return makeGgx(false); }},
};

}  // namespace

std::span<const BrdfKind> brdfKinds() {
  return kKinds;
}

const BrdfKind& brdfKindOf(const Material& material) {
  return *std::ranges::find_if(kKinds, [&](const BrdfKind& kind) { return kind.serves(material); });
}

Result<BrdfTables> BrdfTables::make(const Scene& scene, int order, int shipped) {
  BrdfTables out;
  std::vector<const gltf::Material*> first_of;  // the first material that uses an entry
  for (const gltf::Material& material : scene.materials) {
    std::int32_t& entry = out.of_material.emplace_back(-1);
    if (material.isDiffuse()) continue;
    const BrdfKind& kind = brdfKindOf(material);
    const auto known = std::ranges::find_if(first_of, [&](const gltf::Material* first) {
      return &brdfKindOf(*first) == &kind && first->brdf == material.brdf;
    });
    entry = static_cast<std::int32_t>(known - first_of.begin());
    if (known != first_of.end()) continue;
    const auto brdf = kind.make(scene, material);
    if (!brdf) return failAgain(brdf.error());
    first_of.push_back(&material);
    out.entries.push_back(
        {kind.family, material.brdf >= 0 ? scene.brdfs[static_cast<std::size_t>(material.brdf)].name : "",
         integrateTable(**brdf, order, gridFor(**brdf, shipped))});
  }
  return out;
}

bundle::BrdfTable firstBands(const bundle::BrdfTable& table, int order) {
  bundle::BrdfTable out = table;
  out.order = static_cast<std::uint32_t>(order);
  const std::size_t from = table.coefficients(), to = out.coefficients();
  assert(to <= from);
  out.values.clear();
  for (std::size_t first = 0; first < table.values.size(); first += from)
    out.values.insert(out.values.end(), table.values.begin() + static_cast<std::ptrdiff_t>(first),
                      table.values.begin() + static_cast<std::ptrdiff_t>(first + to));
  return out;
}

}  // namespace lambent::baker
