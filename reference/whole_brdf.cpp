#include "reference/whole_brdf.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

#include <glm/common.hpp>
#include <glm/geometric.hpp>
#include <glm/vec2.hpp>
#include <glm/vec3.hpp>

#include "baker/import/measured_brdf.hpp"
#include "baker/jobs/parallel.hpp"
#include "reference/brdf.hpp"
#include "reference/sampler.hpp"
#include "reference/warp.hpp"

namespace lambent::baker::reference {

namespace {

// Interpolates a measured BRDF for the reference (docs/conventions.md, "Materials") by a weighted mean over
// the half-vector and difference angles, tabulated once. It is scaled down where it would reflect more energy
// than it receives.

class MeasuredReflection final : public WholeBrdf {
 public:
  explicit MeasuredReflection(const MeasuredBrdf& measured);

  glm::vec3 value(const glm::vec3& v, const glm::vec3& s) const override;
  float alpha() const override { return alpha_; }

 private:
  glm::vec3 unscaled(const glm::vec3& v, const glm::vec3& s) const;
  float scale(float cosine) const;

  std::vector<glm::vec3> values_;  // [theta_d][sqrt of theta_h]
  std::vector<float> scales_;      // by the square root of the cosine
  float alpha_ = 0.2f;
};

constexpr std::size_t kHalves = 257, kDifferences = 129;  // nodes of the table
constexpr std::size_t kAngles = 65;                       // nodes of the scale
constexpr std::uint32_t kIntegralPoints = 2048;           // sample points of each integral
constexpr double kSharpness = 400.0;                      // of the interpolation weights: 1/(2 sigma²)

// Returns half-vector and difference angles as coordinates 0..1 (Rusinkiewicz 1998).
glm::dvec2 placeOf(const glm::dvec3& v, const glm::dvec3& s) {
  const glm::dvec3 sum = v + s;
  // This uses atan2, because the arc cosine of a small angle has no significant digits.
  const double half = std::atan2(std::sqrt(sum.x * sum.x + sum.y * sum.y), sum.z);
  const double difference = std::atan2(glm::length(v - s), glm::length(sum));
  constexpr double kQuarter = std::numbers::pi / 2;
  return {std::sqrt(std::clamp(half / kQuarter, 0.0, 1.0)), std::clamp(difference / kQuarter, 0.0, 1.0)};
}

glm::dvec3 directionOf(float theta, float phi) {
  const double t = theta, p = phi;
  return {std::sin(t) * std::cos(p), std::sin(t) * std::sin(p), std::cos(t)};
}

struct Weighed {
  glm::dvec2 place;
  glm::dvec3 value;
};

glm::vec3 meanAt(const std::vector<Weighed>& all, const glm::dvec2& place) {
  const auto distance2 = [&](const Weighed& one) {
    const glm::dvec2 away = one.place - place;
    return glm::dot(away, away);
  };
  // Weights are relative to the nearest measurement, or they would underflow far from all of them.
  double nearest = distance2(all.front());
  for (const Weighed& one : all) nearest = std::min(nearest, distance2(one));
  double weights = 0.0;
  glm::dvec3 sum(0.0);
  for (const Weighed& one : all) {
    const double beyond = kSharpness * (distance2(one) - nearest);
    if (beyond > 40.0) continue;
    const double weight = std::exp(-beyond);
    weights += weight;
    sum += weight * one.value;
  }
  return glm::vec3(sum / weights);
}

// Returns the node below a coordinate 0..1 among `nodes`, and the fraction of the way to the next.
std::pair<std::size_t, float> nodeBelow(double at, std::size_t nodes) {
  const double scaled = std::clamp(at, 0.0, 1.0) * static_cast<double>(nodes - 1);
  const auto below = std::min(static_cast<std::size_t>(scaled), nodes - 2);
  return {below, static_cast<float>(scaled - static_cast<double>(below))};
}

float largestChannel(const glm::vec3& v) {
  return std::max({v.r, v.g, v.b});
}

MeasuredReflection::MeasuredReflection(const MeasuredBrdf& measured) {
  std::vector<Weighed> all;
  for (const BrdfMeasurement& m : measured.measurements)
    all.push_back(
        {placeOf(directionOf(m.theta_i, m.phi_i), directionOf(m.theta_o, m.phi_o)), glm::dvec3(m.value)});
  values_.resize(kHalves * kDifferences);
  parallelRanges(kDifferences, 1, {}, [&](std::size_t first, std::size_t last) {
    for (std::size_t d = first; d < last; ++d)
      for (std::size_t h = 0; h < kHalves; ++h)
        values_[d * kHalves + h] = meanAt(
            all, {static_cast<double>(h) / (kHalves - 1), static_cast<double>(d) / (kDifferences - 1)});
  });
  // The width of the highlight at theta_d = 30°: GGX falls to half where tan theta_h = 0.644 alpha.
  const glm::vec3* row = &values_[kDifferences / 3 * kHalves];
  const float base = largestChannel(row[kHalves * 4 / 5]), half = 0.5f * (largestChannel(row[0]) + base);
  std::size_t h = 1;
  while (h + 1 < kHalves && largestChannel(row[h]) > half) ++h;
  const float root = static_cast<float>(h) / (kHalves - 1);
  alpha_ = std::clamp(std::tan(std::min(kPi / 2 * root * root, 1.2f)) / 0.644f, 0.02f, 1.0f);
  // Computes the reflection of uniform light.
  scales_.resize(kAngles);
  parallelRanges(kAngles, 1, {}, [&](std::size_t first, std::size_t last) {
    for (std::size_t a = first; a < last; ++a) {
      const float root_of_cosine = static_cast<float>(a) / (kAngles - 1);
      const float cosine = std::max(root_of_cosine * root_of_cosine, kLeastCosine);
      Reflector reflector{.view = {std::sqrt(std::max(1.0f - cosine * cosine, 0.0f)), 0.0f, cosine},
                          .alpha = glm::vec2(alpha_),
                          .specular_share = 0.5f};
      const Sampler sampler(/*seed=*/1, static_cast<std::uint32_t>(a), 0);
      glm::dvec3 sum(0.0);
      for (std::uint32_t i = 0; i < kIntegralPoints; ++i) {
        const glm::vec3 s = reflector.sample(i % 2 == 0 ? 0.0f : 1.0f, sampler.pair(i % 2, i / 2));
        if (s.z > 0.0f) sum += glm::dvec3(unscaled(reflector.view, s) * (s.z / reflector.pdf(s)));
      }
      scales_[a] = std::min(1.0f, static_cast<float>(kIntegralPoints) / largestChannel(glm::vec3(sum)));
    }
  });
}

glm::vec3 MeasuredReflection::unscaled(const glm::vec3& v, const glm::vec3& s) const {
  const glm::dvec2 place = placeOf(glm::dvec3(v), glm::dvec3(s));
  const auto [h, right] = nodeBelow(place.x, kHalves);
  const auto [d, down] = nodeBelow(place.y, kDifferences);
  const glm::vec3* at = &values_[d * kHalves + h];
  return glm::mix(glm::mix(at[0], at[1], right), glm::mix(at[kHalves], at[kHalves + 1], right), down);
}

float MeasuredReflection::scale(float cosine) const {
  const auto [a, share] = nodeBelow(std::sqrt(std::max(cosine, 0.0f)), kAngles);
  return glm::mix(scales_[a], scales_[a + 1], share);
}

glm::vec3 MeasuredReflection::value(const glm::vec3& v, const glm::vec3& s) const {
  return unscaled(v, s) * std::min(scale(v.z), scale(s.z));
}

using gltf::Material;

struct Kind {
  bool (*serves)(const Material&);                     // not called for diffuse materials
  bool (*same)(const Material& a, const Material& b);  // whether two such materials reflect alike
  std::shared_ptr<const WholeBrdf> (*make)(const Scene&, const Material&);
};

// Earlier rows have priority.
constexpr std::array kKinds = {
    Kind{[](const Material& m) { return m.brdf >= 0; },
         [](const Material& a, const Material& b) { return a.brdf == b.brdf; },
         [](const Scene& scene, const Material& m) -> std::shared_ptr<const WholeBrdf> {
           return std::make_shared<MeasuredReflection>(scene.brdfs[static_cast<std::size_t>(m.brdf)]);
         }},
};

}  // namespace

std::vector<std::shared_ptr<const WholeBrdf>> wholeBrdfs(const Scene& scene) {
  struct Made {
    const Kind* kind;
    const Material* material;
    std::shared_ptr<const WholeBrdf> brdf;
  };
  std::vector<Made> all;
  std::vector<std::shared_ptr<const WholeBrdf>> of_material;
  for (const Material& material : scene.materials) {
    auto& own = of_material.emplace_back();
    const auto kind = std::ranges::find_if(kKinds, [&](const Kind& k) { return k.serves(material); });
    if (material.isDiffuse() || kind == kKinds.end()) continue;
    auto known = std::ranges::find_if(
        all, [&](const Made& made) { return made.kind == &*kind && kind->same(*made.material, material); });
    if (known == all.end()) known = all.insert(all.end(), {&*kind, &material, kind->make(scene, material)});
    own = known->brdf;
  }
  return of_material;
}

}  // namespace lambent::baker::reference
