// Tests the reference's own BRDFs: energy, reciprocity, and that the densities match the sampled directions.
#include <gtest/gtest.h>

#include "reference/sampler.hpp"
#include "reference/surfaces.hpp"
#include "tests/reference/measure.hpp"
#include "tests/reference/quadrature.hpp"

namespace lambent::baker::reference {
namespace {

using testing::Ggx;

constexpr float kRoughness[] = {0.0f, 0.1f, 0.3f, 0.5f, 0.8f, 1.0f};
constexpr float kCosines[] = {1.0f, 0.7f, 0.3f, 0.1f, 0.02f, 0.001f};

glm::vec3 viewAt(float cosine, float azimuth = 0.7f) {
  const float side = std::sqrt(std::max(0.0f, 1.0f - cosine * cosine));
  return {side * std::cos(azimuth), side * std::sin(azimuth), cosine};
}

// Makes a floor whose frame is known: x along +X, y along -Z, z up.
struct Floor {
  Surfaces surfaces;
  Reflector towards(const glm::vec3& local_view) const {
    const glm::vec3 view(local_view.x, local_view.z, -local_view.y);
    return surfaces.pointAt({.surface = 0, .triangle = 0, .u = 0.3f, .v = 0.3f, .t = 1.0f}, -view).reflector;
  }
};
Floor knownFloor(const gltf::Material& material) {
  Scene scene = testing::sceneOf({testing::grid({0, 0, 0}, 2.0f, 1)});
  auto& mesh = scene.meshes[0].primitives[0].mesh;
  mesh.tangents.assign(mesh.positions.size(), glm::vec4(1, 0, 0, 1));
  scene.materials = {material};
  return {std::move(*Surfaces::build(scene))};
}

gltf::Material metal(float roughness, float anisotropy = 0.0f) {
  gltf::Material material;
  material.roughness = roughness;
  material.anisotropy = anisotropy;
  return material;
}
gltf::Material plastic(float roughness, float ior = 1.5f) {
  gltf::Material material;
  material.metallic = 0.0f;
  material.roughness = roughness;
  material.ior = ior;
  return material;
}

// Estimates the reflection of uniform light by the reflector's own samples.
glm::dvec3 furnace(const Reflector& reflector, std::uint32_t points = 1u << 14) {
  const Sampler sampler(5, 6, 0);
  glm::dvec3 sum(0.0);
  for (std::uint32_t i = 0; i < points; ++i) {
    const glm::vec3 s = reflector.sample(sampler.pair(1, i).x, sampler.pair(0, i));
    const float pdf = reflector.pdf(s);
    if (s.z > 0.0f && pdf > 0.0f) sum += glm::dvec3(reflector.value(s) / pdf);
  }
  return sum / static_cast<double>(points);
}

Ggx lobeOf(const Reflector& reflector) {
  return {double{reflector.alpha.x}, double{reflector.alpha.y}};
}

TEST(Brdf, OfMetalsReflectsOfUniformLightWhatQuadratureSays) {
  for (const float roughness : kRoughness) {
    const Floor floor = knownFloor(metal(roughness));
    for (const float cosine : kCosines) {
      const Reflector reflector = floor.towards(viewAt(cosine));
      const glm::dvec2 parts = lobeOf(reflector).albedo(glm::dvec3(reflector.view));
      const double seen = furnace(reflector).g;
      EXPECT_NEAR(seen, parts.x + parts.y, 0.005) << roughness << " " << cosine;
      EXPECT_LE(seen, 1.0 + 1e-5) << roughness << " " << cosine;
    }
  }
}

TEST(Brdf, OfDielectricsGivesTheDiffusePartWhatTheSpecularOneLeaves) {
  for (const float ior : {1.0f, 1.5f, 2.5f, 0.0f})
    for (const float roughness : kRoughness) {
      gltf::Material material = plastic(roughness, ior);
      if (material.isDiffuse()) material.roughness = 0.99f;
      material.base_color = glm::vec4(1.0f, 0.5f, 0.0f, 1.0f);
      const Floor floor = knownFloor(material);
      const double step = ior > 0.0f ? (double{ior} - 1.0) / (double{ior} + 1.0) : 1.0;
      for (const float cosine : kCosines) {
        const Reflector reflector = floor.towards(viewAt(cosine));
        const glm::dvec2 parts = lobeOf(reflector).albedo(glm::dvec3(reflector.view));
        const double specular = step * step * parts.x + parts.y;
        const glm::dvec3 seen = furnace(reflector);
        EXPECT_NEAR(seen.r, specular + (1.0 - specular), 0.005) << ior << " " << roughness << " " << cosine;
        EXPECT_NEAR(seen.g, specular + 0.5 * (1.0 - specular), 0.005)
            << ior << " " << roughness << " " << cosine;
        EXPECT_NEAR(seen.b, specular, 0.005) << ior << " " << roughness << " " << cosine;
        EXPECT_LE(seen.r, 1.003) << ior << " " << roughness << " " << cosine;
      }
    }
}

TEST(Brdf, IsReciprocalInItsSpecularPart) {
  for (const float strength : {0.0f, 0.7f}) {
    const Floor floor = knownFloor(metal(0.5f, strength));
    for (int i = 0; i < 50; ++i) {
      const glm::vec3 a = viewAt(0.05f + 0.019f * static_cast<float>(i), 2.4f * static_cast<float>(i)),
                      b = viewAt(0.03f + 0.017f * static_cast<float>(i * 7 % 50),
                                 1.3f * static_cast<float>(i));
      const double there = double{floor.towards(a).specular(b).g} / double{b.z},
                   back = double{floor.towards(b).specular(a).g} / double{a.z};
      EXPECT_NEAR(there, back, 1e-5 * there);
      const Ggx lobe = lobeOf(floor.towards(a));
      const glm::dvec2 parts = lobe.value(glm::dvec3(a), glm::dvec3(b));
      EXPECT_NEAR(there, parts.x + parts.y, 1e-4 * there);
    }
  }
}

// Returns chi-square over 10 x 20 cells of the sphere.
void expectDrawnByDensity(const Reflector& reflector, const char* what) {
  constexpr int kRows = 10, kColumns = 20, kFine = 24;
  constexpr std::uint32_t kDraws = 40000;
  std::array<double, kRows * kColumns> expected{}, drawn{};
  for (int r = 0; r < kRows * kFine; ++r)
    for (int c = 0; c < kColumns * kFine; ++c) {
      const float z = 1.0f - 2.0f * (static_cast<float>(r) + 0.5f) / (kRows * kFine);
      const glm::vec3 s = viewAt(z, 2.0f * kPi * (static_cast<float>(c) + 0.5f) / (kColumns * kFine));
      const std::size_t cell = static_cast<std::size_t>(r / kFine * kColumns + c / kFine);
      expected[cell] +=
          double{reflector.pdf(s)} * 4.0 * std::numbers::pi * kDraws / (kRows * kColumns * kFine * kFine);
    }
  std::uint32_t state = 1;
  const auto next = [&] { return unitFloat(hash32(state++)); };
  for (std::uint32_t i = 0; i < kDraws; ++i) {
    const float choice = next(), x = next(), y = next();
    const glm::vec3 s = reflector.sample(choice, {x, y});
    float turn = std::atan2(s.y, s.x) / (2.0f * kPi);
    if (turn < 0.0f) turn += 1.0f;
    const int r = std::min(static_cast<int>((1.0f - s.z) / 2.0f * kRows), kRows - 1),
              c = std::min(static_cast<int>(turn * kColumns), kColumns - 1);
    drawn[static_cast<std::size_t>(r * kColumns + c)] += 1.0;
  }
  double chi2 = 0.0, rest_expected = 0.0, rest_drawn = 0.0;
  int cells = 0;
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (expected[i] < 20.0) {
      rest_expected += expected[i], rest_drawn += drawn[i];
      continue;
    }
    chi2 += (drawn[i] - expected[i]) * (drawn[i] - expected[i]) / expected[i];
    ++cells;
  }
  EXPECT_NEAR(rest_drawn, rest_expected, 5.0 * std::sqrt(rest_expected) + 0.002 * kDraws) << what;
  EXPECT_GT(cells, 10) << what;
  // The bound is five standard deviations of chi-square, plus the error of integrating the densities on a
  // grid.
  EXPECT_LT(chi2, cells + 5.0 * std::sqrt(2.0 * cells) + 10.0) << what;
}

TEST(Brdf, DirectionsAreDrawnAsTheirDensitiesSay) {
  for (const float cosine : {0.95f, 0.4f, 0.05f}) {
    expectDrawnByDensity(knownFloor(metal(0.6f)).towards(viewAt(cosine)), "metal");
    expectDrawnByDensity(knownFloor(metal(0.5f, 0.7f)).towards(viewAt(cosine, 2.0f)), "anisotropic");
    expectDrawnByDensity(knownFloor(plastic(0.7f)).towards(viewAt(cosine)), "plastic");
    Reflector measured = knownFloor(plastic(0.7f)).towards(viewAt(cosine));  // draws as a measured one would
    measured.specular_share = 0.5f;
    expectDrawnByDensity(measured, "measured");
  }
}

TEST(Brdf, OfAViewUnderThePlaneIsThatOfTheLowestOneInItsDirection) {
  const Floor floor = knownFloor(metal(0.4f));
  const Reflector low = floor.towards(viewAt(0.0f)), lifted = floor.towards(viewAt(kLeastCosine));
  for (const float azimuth : {0.0f, 1.0f, 3.0f})
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(low.value(viewAt(0.2f, azimuth))[c], lifted.value(viewAt(0.2f, azimuth))[c],
                  1e-4f * lifted.value(viewAt(0.2f, azimuth))[c]);
  for (const glm::vec3 view : {glm::vec3(0, 0, -1), glm::vec3(0.6f, 0, -0.8f)}) {
    const glm::vec3 up = liftedView(view);
    EXPECT_NEAR(glm::length(up), 1.0f, 1e-6f);
    EXPECT_EQ(up.z, kLeastCosine);
  }
}

TEST(Brdf, TurnsItsLobeByRotationAndTexture) {
  gltf::Material material = metal(0.3f, 0.8f);
  const auto along = [&] { return glm::abs(knownFloor(material).towards({0, 0, 1}).world_from_local[0]); };
  EXPECT_NEAR(along().x, 1.0f, 1e-6f);
  material.anisotropy_rotation_rad = kPi / 2.0f;  // towards the bitangent
  EXPECT_NEAR(along().z, 1.0f, 1e-6f);
  material.anisotropy_rotation_rad = kPi / 4.0f;  // between +X and cross(n, t) = -Z
  const glm::mat3 frame = knownFloor(material).towards({0, 0, 1}).world_from_local;
  EXPECT_NEAR(std::abs(glm::dot(frame[0], glm::normalize(glm::vec3(1, 0, -1)))), 1.0f, 1e-6f);
  EXPECT_NEAR(glm::dot(frame[2], glm::vec3(0, 1, 0)), 1.0f, 1e-6f);
}

}  // namespace
}  // namespace lambent::baker::reference
