// Measures the error of evaluating glossy shading at vertices instead of pixels: the figures of
// docs/design/glossy.md, "Shading per pixel".
#include <fmt/format.h>
#include <glm/gtc/constants.hpp>
#include <gtest/gtest.h>

#include "baker/brdf/brdf.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/effects/diffuse/diffuse_fixture.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::glossy {
namespace {

// Views an unoccluded sphere of this many rings from a distance of three radii, and returns the relative RMS
// difference between radiance at interpolated normals and radiance interpolated between the triangles'
// corners.
double facetError(const glsl::Table& table, float roughness, int rings, std::span<const glm::vec4> light) {
  lambent::testing::BundleMaker maker(71);
  const glm::vec3 eye(0.0f, 0.0f, 3.0f);
  const auto radiance = [&](const glm::vec3& normal, const glm::vec3& place) {
    const glsl::Reflection got = table.reflect({normal, {}, glm::normalize(eye - place), roughness}, light);
    return got.f0_light.x + got.f90_light.x;
  };
  const auto vertex = [&](int r, int s) {
    const float theta = glm::pi<float>() * static_cast<float>(r) / static_cast<float>(rings);
    const float phi = glm::pi<float>() * static_cast<float>(s) / static_cast<float>(rings);
    return glm::vec3(std::sin(theta) * std::cos(phi), std::cos(theta), std::sin(theta) * std::sin(phi));
  };
  double squared = 0.0, power = 0.0;
  for (int i = 0; i < 3000; ++i) {
    const int r = static_cast<int>(maker.below(static_cast<std::uint32_t>(rings)));
    const int s = static_cast<int>(maker.below(static_cast<std::uint32_t>(2 * rings)));
    const glm::vec3 a = vertex(r, s), b = vertex(r + 1, s), c = vertex(r + 1, s + 1);
    float u = maker.uniform(0, 1), v = maker.uniform(0, 1);
    if (u + v > 1.0f) {
      u = 1.0f - u;
      v = 1.0f - v;
    }
    const glm::vec3 place = a + u * (b - a) + v * (c - a);
    if (place.z < 0.4f) continue;  // turned away, or nearly
    const float exact = radiance(glm::normalize(place), place);
    const float mixed = (1.0f - u - v) * radiance(a, a) + u * radiance(b, b) + v * radiance(c, c);
    squared += static_cast<double>((mixed - exact) * (mixed - exact));
    power += static_cast<double>(exact * exact);
  }
  return std::sqrt(squared / power);
}

}  // namespace

TEST(GlossyFacets, VerticesAreTooFewForHighlightsOnCoarseMeshes) {
  const bundle::BrdfTable ggx = baker::integrateTable(
      *baker::makeGgx(false), 5, {.angles = 16, .azimuths = 1, .roughnesses = 11, .strengths = 1});
  const glsl::Table table(ggx);
  const sh::LightVector sun = sh::discLight(5, glm::normalize(glm::vec3(1, 2, 2)), 0.2, glm::vec3(10.0f)) +
                              sh::constantLight(5, glm::vec3(0.5f));
  std::vector<glm::vec4> light;
  for (std::size_t k = 0; k < 25; ++k) light.emplace_back(sun.c[k], 0.0f);
  for (const float roughness : {0.3f, 0.5f, 0.8f})
    for (const int rings : {8, 16, 32, 64}) {
      const double error = facetError(table, roughness, rings, light);
      fmt::print("roughness {:.1f}, {:2} rings: {:.4f}\n", roughness, rings, error);
      if (roughness < 0.4f && rings == 16) {
        EXPECT_GT(error, 0.02);
      }
      if (rings == 64) {
        EXPECT_LT(error, 0.01);
      }
    }
}

}  // namespace lambent::glossy
