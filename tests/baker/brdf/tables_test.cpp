#include <algorithm>
#include <array>
#include <cmath>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#include "baker/brdf/brdf.hpp"
#include "baker/jobs/parallel.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/baker/brdf/quadrature.hpp"

namespace lambent::baker {
namespace {

using bundle::BrdfView;
using testing::kPi;

const double kWhole = 2 * std::sqrt(kPi);  // sqrt(4 pi)
const std::array<float, 8> kCosines = {0.001f, 0.005f, 0.02f, 0.1f, 0.3f, 0.6f, 0.9f, 1.0f};

// Integrates both lobes for one view, with as many directions as tables use.
std::vector<double> kernel(const Brdf& brdf, const BrdfParameters& at, const BrdfView& view, int order,
                           std::size_t directions = 4096) {
  std::vector<double> b(brdf.lobes() * static_cast<std::size_t>(order * order));
  integrateView(brdf, at, view, order, directions, b);
  return b;
}

double normOf(const std::vector<double>& a) {
  double sum = 0;
  for (const double x : a) sum += x * x;
  return std::sqrt(sum);
}

// Lambert's law has a closed form that does not depend on the view.
class Lambert final : public Brdf {
 public:
  std::uint32_t lobes() const override { return 3; }
  bool isotropic() const override { return true; }
  bool hasRoughness() const override { return false; }
  BrdfFocus focus(const BrdfParameters&) const override {
    return {.alpha_t = 0.3, .alpha_b = 0.3, .cosine_share = 0.5};
  }
  void value(const BrdfParameters&, const glm::dvec3&, const glm::dvec3&,
             std::span<double> out) const override {
    out[0] = 0.8 / kPi, out[1] = 0.5 / kPi, out[2] = 0;
  }
};

TEST(BrdfTables, OfLambertAreTheClampedCosineWhateverTheView) {
  constexpr std::array<double, 3> kAlbedo = {0.8, 0.5, 0};
  const bundle::BrdfTable table = integrateTable(Lambert(), 6);
  EXPECT_EQ(table.roughnesses, 1u);
  std::vector<float> b(3 * 36);
  for (const float cosine : kCosines) {
    lookUp(table, {.cos_theta = cosine}, 0.5f, 0.0f, b);
    for (std::size_t lobe = 0; lobe < 3; ++lobe)
      for (int l = 0; l < 6; ++l)
        for (int m = -l; m <= l; ++m) {
          const double expected =
              m == 0 ? kAlbedo[lobe] * sh::clampedCosine(l) / kPi * std::sqrt((2 * l + 1) / (4 * kPi)) : 0;
          EXPECT_NEAR(b[lobe * 36 + static_cast<std::size_t>(sh::coefficientIndex(l, m))], expected, 1e-3)
              << "cos " << cosine << ", lobe " << lobe << ": " << l << ", " << m;
        }
  }
}

// White-furnace test: compares the reflection of uniform light with a quadrature that does not sample lobes.
TEST(BrdfTables, HaveTheDirectionalAlbedoOfEachGgxLobe) {
  const auto ggx = makeGgx(/*anisotropic=*/false);
  for (const float roughness : {0.1f, 0.2f, 0.35f, 0.5f, 0.7f, 0.85f, 1.0f})
    for (const float cosine : kCosines) {
      const BrdfParameters at{.roughness = roughness};
      const BrdfView view{.cos_theta = cosine};
      const glm::dvec3 v = testing::localView(view);
      const auto b = kernel(*ggx, at, view, 1);
      for (std::size_t lobe = 0; lobe < 2; ++lobe) {
        const double albedo = testing::HemisphereIntegral(2e-7)([&](const glm::dvec3& s) {
          std::array<double, 3> f{};
          ggx->value(at, v, s, f);
          return f[lobe] * s.z;
        });
        EXPECT_NEAR(kWhole * b[lobe], albedo, 1e-3)
            << "roughness " << roughness << ", cos " << cosine << ", lobe " << lobe;
        EXPECT_GE(b[lobe], 0);
      }
      EXPECT_LE(kWhole * (b[0] + b[1]), 1 + 1e-6);
    }
}

TEST(BrdfTables, HaveTheDirectionalAlbedoOfAnisotropicGgx) {
  const auto ggx = makeGgx(/*anisotropic=*/true);
  for (const float roughness : {0.2f, 0.5f, 0.8f})
    for (const float strength : {0.3f, 1.0f})
      for (const float cosine : {0.01f, 0.3f, 0.8f, 1.0f})
        for (const float phi : {0.0f, 0.7f, 1.5f}) {
          const BrdfParameters at{.roughness = roughness, .strength = strength};
          const BrdfView view{cosine, std::cos(phi), std::sin(phi)};
          const glm::dvec3 v = testing::localView(view);
          const auto b = kernel(*ggx, at, view, 1, 2048);
          const double albedo = testing::HemisphereIntegral(1e-6)([&](const glm::dvec3& s) {
            std::array<double, 3> f{};
            ggx->value(at, v, s, f);
            return (f[0] + f[1]) * s.z;
          });
          EXPECT_NEAR(kWhole * (b[0] + b[1]), albedo, 2.5e-3)
              << roughness << ", strength " << strength << ", cos " << cosine << ", phi " << phi;
          EXPECT_LE(kWhole * (b[0] + b[1]), 1 + 1e-6);
        }
}

// Compares every coefficient, not only the first.
TEST(BrdfTables, ProjectTheLobeOnEveryFunction) {
  const auto ggx = makeGgx(true);
  const BrdfParameters at{.roughness = 0.5f, .strength = 0.6f};
  const BrdfView view{0.4f, 0.8f, 0.6f};
  const glm::dvec3 v = testing::localView(view);
  const auto b = kernel(*ggx, at, view, 5, 4096);
  for (int i = 0; i < 25; ++i)
    for (std::size_t lobe = 0; lobe < 2; ++lobe) {
      const double expected = testing::HemisphereIntegral(1e-7)([&](const glm::dvec3& s) {
        std::array<double, 3> f{};
        std::array<double, 25> y;
        ggx->value(at, v, s, f);
        // This transforms the direction into the frame of the view.
        sh::evaluate(5, glm::dvec3(0.8 * s.x + 0.6 * s.y, 0.8 * s.y - 0.6 * s.x, s.z), y);
        return f[lobe] * s.z * y[static_cast<std::size_t>(i)];
      });
      EXPECT_NEAR(b[lobe * 25 + static_cast<std::size_t>(i)], expected, 1e-3) << "lobe " << lobe << ": " << i;
    }
}

TEST(BrdfTables, NeverReflectMoreThanTheyReceive) {
  const bundle::BrdfTable table = integrateTable(*makeGgx(false), 2);
  const std::size_t count = table.coefficients();
  for (std::size_t node = 0; node < table.nodes(); ++node) {
    const float* b = table.values.data() + node * table.nodeValues();
    EXPECT_GE(b[0], 0.0f);
    EXPECT_GE(b[count], 0.0f);
    EXPECT_LE(static_cast<float>(kWhole) * (b[0] + b[count]), 1.0f + 1e-5f) << node;
  }
}

// A mirror gives y_k(mirrored view), even at grazing angles, and although alpha is clamped to 0.001.
TEST(BrdfTables, OfSmoothSurfacesAreMirrors) {
  const auto ggx = makeGgx(false);
  for (const float cosine : {0.1f, 0.3f, 0.7f, 1.0f}) {
    const auto b = kernel(*ggx, {.roughness = 0.0f}, {.cos_theta = cosine}, 6);
    std::array<double, 36> y;
    const double z = static_cast<double>(cosine);
    sh::evaluate(6, glm::dvec3(-std::sqrt(1 - z * z), 0, z), y);
    const double fresnel = std::pow(1 - z, 5);
    for (std::size_t k = 0; k < 36; ++k) {
      EXPECT_NEAR(b[k], (1 - fresnel) * y[k], 2e-3) << cosine << ": " << k;
      EXPECT_NEAR(b[36 + k], fresnel * y[k], 2e-3) << cosine << ": " << k;
    }
  }
}

// Compares interpolation between nodes with integration at that place; docs/design/glossy.md has the
// mean error.
TEST(BrdfTables, InterpolateWithinHalfAPercentWhereFiveBandsCarryTheLobe) {
  const auto ggx = makeGgx(false);
  const bundle::BrdfTable table = integrateTable(*ggx, 5);
  std::vector<float> found(50);
  for (float roughness = 0.252f; roughness < 1.0f; roughness += 0.0371f)
    for (float u = 0.033f; u < 1.0f; u += 0.0231f) {
      const float cosine = 1 - (1 - u * u) * (1 - u * u);
      const auto expected = kernel(*ggx, {.roughness = roughness}, {.cos_theta = cosine}, 5);
      lookUp(table, {.cos_theta = cosine}, roughness, 0.0f, found);
      std::vector<double> metal(25), error(25), glass(25), glass_error(25);
      for (std::size_t k = 0; k < 25; ++k) {
        const double f0 = found[k], f90 = found[25 + k];
        metal[k] = expected[k] + expected[25 + k];
        error[k] = f0 + f90 - metal[k];
        glass[k] = 0.04 * expected[k] + expected[25 + k];
        glass_error[k] = 0.04 * f0 + f90 - glass[k];
      }
      EXPECT_LT(normOf(error), 0.005 * normOf(metal)) << "roughness " << roughness << ", cos " << cosine;
      EXPECT_LT(normOf(glass_error), 0.0075 * normOf(glass))
          << "roughness " << roughness << ", cos " << cosine;
    }
}

// Measures the fraction of a lobe's energy (∫ (f cos)²) in five bands, for a view along the normal. The
// planning of glossy transfer uses these figures.
TEST(BrdfTables, HoldTheKnownShareOfTheLobesEnergy) {
  const auto ggx = makeGgx(false);
  const BrdfView view{.cos_theta = 1.0f};
  const glm::dvec3 v(0, 0, 1);
  for (const auto& [roughness, share] : {std::pair{0.5f, 0.92}, {0.4f, 0.71}, {0.3f, 0.38}}) {
    const BrdfParameters at{.roughness = roughness};
    const auto b = kernel(*ggx, at, view, 5);
    double held = 0;
    for (std::size_t k = 0; k < 25; ++k) held += (b[k] + b[25 + k]) * (b[k] + b[25 + k]);
    const double all = testing::HemisphereIntegral(1e-6)([&](const glm::dvec3& s) {
      std::array<double, 3> f{};
      ggx->value(at, v, s, f);
      return (f[0] + f[1]) * (f[0] + f[1]) * s.z * s.z;
    });
    EXPECT_NEAR(held / all, share, 0.01) << "roughness " << roughness;
  }
}

}  // namespace
}  // namespace lambent::baker
