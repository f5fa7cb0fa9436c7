// Compares the kernel, compiled as C++, with spherical harmonics that are evaluated and rotated directly.
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/rotation.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/runtime/evaluate/random_table.hpp"
#include "tests/support/glsl/glossy_kernels.hpp"

namespace lambent::glossy {

using testing::randomTable;

namespace {

std::vector<glm::vec4> randomLight(lambent::testing::BundleMaker& maker, std::uint32_t bands) {
  std::vector<glm::vec4> light(bands * bands);
  for (glm::vec4& value : light)
    value = {maker.uniform(-1, 1), maker.uniform(-1, 1), maker.uniform(-1, 1), maker.uniform(-1, 1)};
  return light;
}

// Returns the sum of c_k light_k, where c is the function in the local frame, by evaluating both in many
// directions of a sphere: exact for so few bands.
glm::vec4 product(std::uint32_t bands, std::span<const float> local, const glm::mat3& group_from_local,
                  std::span<const glm::vec4> light) {
  glm::dvec4 sum(0.0);
  constexpr int kRings = 48, kSides = 48;
  std::vector<double> y(bands * bands), y_local(bands * bands);
  for (int r = 0; r < kRings; ++r)
    for (int s = 0; s < kSides; ++s) {
      // Gauss-Chebyshev would be exact; midpoints in the height are to 1e-3 of 1/48² with these few bands.
      const double z = -1.0 + (2.0 * r + 1.0) / kRings, phi = 2.0 * std::numbers::pi * s / kSides;
      const double ring = std::sqrt(1.0 - z * z);
      const glm::dvec3 d(ring * std::cos(phi), ring * std::sin(phi), z);
      sh::evaluate(static_cast<int>(bands), d, y);
      sh::evaluate(static_cast<int>(bands), glm::transpose(glm::dmat3(group_from_local)) * d, y_local);
      double kernel = 0.0;
      glm::dvec4 arriving(0.0);
      for (std::size_t k = 0; k < y.size(); ++k) {
        kernel += static_cast<double>(local[k]) * y_local[k];
        arriving += y[k] * glm::dvec4(light[k]);
      }
      sum += kernel * arriving * (4.0 * std::numbers::pi / (kRings * kSides));
    }
  return glm::vec4(sum);
}

}  // namespace

TEST(GlossyKernel, BandsOfTheLightAreItsHarmonicsBandByBand) {
  lambent::testing::BundleMaker maker(51);
  const auto check = [&]<int Bands>() {
    for (int i = 0; i < 30; ++i) {
      const glm::vec3 direction = i == 0 ? glm::vec3(0, 0, 1) : maker.direction();
      std::vector<glm::vec4> light = randomLight(maker, Bands);
      glm::vec4 got[Bands];
      glsl::Kernel<Bands, glsl::Lobes::Two>().bandsAt(direction, light.data(), got);
      float y[Bands * Bands];
      sh::evaluate(Bands, direction, y);
      for (int l = 0; l < Bands; ++l) {
        glm::vec4 expected(0.0f);
        for (int k = l * l; k < (l + 1) * (l + 1); ++k) expected += y[k] * light[static_cast<std::size_t>(k)];
        EXPECT_LT(glm::distance(got[l], expected), 5e-6f) << "band " << l << " of " << Bands;
      }
    }
  };
  check.operator()<4>();
  check.operator()<5>();
  check.operator()<6>();
}

TEST(GlossyKernel, WeighsTheLightByTheTableTurnedToTheFrame) {
  lambent::testing::BundleMaker maker(52);
  for (const std::uint32_t bands : {4u, 5u, 6u})
    for (const bool isotropic : {true, false})
      for (const std::uint32_t lobes : {2u, 3u}) {
        if (lobes == 3 && !isotropic) continue;
        const bundle::BrdfTable table = randomTable(maker, bands, isotropic, lobes);
        const glsl::Table packed(table);
        for (int i = 0; i < 4; ++i) {
          const glm::vec3 normal = maker.direction(), tangent = glsl::Isotropic().perpendicular(normal);
          const glm::vec3 away = maker.direction();
          const glm::vec3 to_eye = glm::dot(away, normal) < 0.0f ? -away : away;
          const float roughness = maker.uniform(0, 1), strength = maker.uniform(0, 1);
          const std::vector<glm::vec4> light = randomLight(maker, bands);
          const glsl::Reflection got = packed.reflect({normal, tangent, to_eye, roughness, strength}, light);
          std::vector<float> b(lobes * bands * bands);
          bundle::lookUp(table,
                         {.cos_theta = got.cos_theta, .cos_phi = got.azimuth.x, .sin_phi = got.azimuth.y},
                         roughness, strength, b);
          std::vector<float> cosine(bands * bands);
          sh::unoccludedTransfer(static_cast<int>(bands), normal, cosine);
          glm::vec4 diffuse(0.0f);
          for (std::size_t k = 0; k < cosine.size(); ++k) diffuse += cosine[k] * light[k];
          EXPECT_LT(glm::distance(got.diffuse, diffuse), 1e-5f);
          const glm::mat3 group_from_local(got.tangent, got.bitangent, got.normal);
          const std::size_t n = bands * bands;
          for (std::size_t a = 0; a < lobes; ++a) {
            const glm::vec4 expected =
                product(bands, std::span(b).subspan(a * n, n), group_from_local, light);
            const auto channel = static_cast<int>(a);
            EXPECT_NEAR(got.albedo[channel], 3.5449077f * b[a * n], 1e-5f);
            // Light of size 1, up to 36 coefficients of 0.1; the quadrature is good to 2e-3.
            if (lobes == 3)
              EXPECT_NEAR(got.light[channel], expected[channel], 4e-3f);
            else
              EXPECT_LT(glm::distance(a == 0 ? got.f0_light : got.f90_light, expected), 4e-3f)
                  << bands << " bands, " << (isotropic ? "isotropic" : "anisotropic");
          }
        }
      }
}

TEST(GlossyKernel, UniformLightReturnsTheDirectionalAlbedoFromEveryView) {
  lambent::testing::BundleMaker maker(53);
  for (const bool isotropic : {true, false}) {
    const bundle::BrdfTable table = randomTable(maker, 5, isotropic);
    const glsl::Table packed(table);
    std::vector<glm::vec4> light(25, glm::vec4(0.0f));
    light[0] = glm::vec4(3.5449077f);
    for (int i = 0; i < 50; ++i) {
      const glm::vec3 normal = maker.direction();
      // Views from below among them.
      const glsl::Reflection got = packed.reflect(
          {normal, glsl::Isotropic().perpendicular(normal), maker.direction(), 0.4f, 0.7f}, light);
      EXPECT_NEAR(got.f0_light.x, got.albedo.x, 1e-5f);
      EXPECT_NEAR(got.f90_light.y, got.albedo.y, 1e-5f);
      EXPECT_NEAR(got.f0_light.w, got.albedo.x, 1e-5f) << "visibility 1";
      EXPECT_NEAR(got.diffuse.x, 1.0f, 1e-6f);
    }
  }
}

TEST(GlossyKernel, DiffuseAndReflectedLightTogetherNeverExceedWhatArrives) {
  lambent::testing::BundleMaker maker(54);
  for (int i = 0; i < 500; ++i) {
    const glm::vec3 base(maker.uniform(0, 1), maker.uniform(0, 1), maker.uniform(0, 1));
    const float metallic = maker.uniform(0, 1), specular = maker.uniform(0, 1);
    const auto fresnel =
        glsl::Isotropic().fresnelOf(base, metallic, glm::vec3(maker.uniform(0, 3)), specular);
    // Albedos of the lobes: together at most 1.
    const float a = maker.uniform(0, 1), b = maker.uniform(0, 1 - a);
    const glm::vec3 rho = fresnel.f0 * a + fresnel.f90 * b;
    const glm::vec3 all = rho + glsl::Isotropic().diffuseAlbedo(base, metallic, fresnel, {a, b});
    for (int c = 0; c < 3; ++c) {
      EXPECT_LE(all[c], 1.0f + 1e-6f);
      EXPECT_GE(all[c], 0.0f);
    }
  }
}

TEST(GlossyKernel, AViewBelowTheSurfaceCountsAsOneAlongIt) {
  const glm::vec3 normal(0, 0, 1);
  glsl::Isotropic kernel;
  const auto view = kernel.localView(normal, {}, glm::normalize(glm::vec3(1, 1, -0.5f)));
  EXPECT_EQ(view.cos_theta, bundle::kLeastViewCosine);
  EXPECT_LT(glm::distance(view.tangent, glm::normalize(glm::vec3(1, 1, 0))), 1e-6f);
  const auto pole = kernel.localView(normal, {}, normal);
  EXPECT_EQ(pole.cos_theta, 1.0f);
  EXPECT_NEAR(glm::length(pole.tangent), 1.0f, 1e-6f);
}

TEST(GlossyKernel, CornerWeightsAreBarycentricAndFiniteOnAnyTriangle) {
  lambent::testing::BundleMaker maker(55);
  for (const float size : {1e-20f, 1e-3f, 1.0f, 1e6f})
    for (int i = 0; i < 100; ++i) {
      const glm::vec3 a = size * maker.direction(), b = size * maker.direction(),
                      c = size * maker.direction();
      const float u = maker.uniform(0, 1), v = maker.uniform(0, 1 - u);
      const glm::vec3 weights = glsl::Isotropic().cornerWeights(a + u * (b - a) + v * (c - a), a, b, c);
      EXPECT_LT(glm::distance(weights, glm::vec3(1 - u - v, u, v)), 1e-3f) << "size " << size;
    }
  // Slivers and points: weights stay in 0..1 and sum to 1, along the line where there is one.
  const glm::vec3 a(0.0f), b(1, 0, 0), middle(0.5f, 0, 0), place(0.25f, 0, 0);
  const std::array<glm::vec3, 3> slivers[] = {
      {a, b, b}, {a, a, b}, {b, a, b}, {middle, b, a}, {a, middle, b}};
  for (const auto& corners : slivers) {
    const glm::vec3 weights = glsl::Isotropic().cornerWeights(place, corners[0], corners[1], corners[2]);
    EXPECT_NEAR(weights.x + weights.y + weights.z, 1.0f, 1e-6f);
    EXPECT_LT(glm::distance(weights.x * corners[0] + weights.y * corners[1] + weights.z * corners[2], place),
              1e-6f);
  }
  EXPECT_EQ(glsl::Isotropic().cornerWeights(b, a, a, a), glm::vec3(1.0f / 3.0f));
  const glm::vec3 outside = glsl::Isotropic().cornerWeights({5, 5, 0}, a, b, {0, 1, 0});
  EXPECT_NEAR(outside.x + outside.y + outside.z, 1.0f, 1e-6f);
  EXPECT_GE(std::min(outside.x, std::min(outside.y, outside.z)), 0.0f);
}

}  // namespace lambent::glossy
