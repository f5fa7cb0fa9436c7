// Tests surfaces whose smooth normals differ from their triangles' normals: light between the two planes is
// that of the mirror image, and no energy is lost.
#include <gtest/gtest.h>

#include "reference/brdf.hpp"
#include "reference/sampler.hpp"
#include "tests/reference/measure.hpp"
#include "tests/reference/quadrature.hpp"
#include "tests/support/differences.hpp"

namespace lambent::baker::reference {
namespace {

using testing::add;
using testing::Ggx;
using testing::kPlace;
using testing::measured;
using testing::samples;
using testing::sceneOf;

gltf::Material isotropicMetal(float roughness) {
  gltf::Material material;
  material.metallic = 1.0f;
  material.roughness = roughness;
  return material;
}

glm::vec3 leaning(float degrees) {
  const float lean = glm::radians(degrees);
  return {std::sin(lean), std::cos(lean), 0.0f};
}

// Makes a floor whose normals are tilted by this much towards +X.
Scene floorThatLeans(const gltf::Material& material, float degrees) {
  Scene floor = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
  for (glm::vec3& n : floor.meshes[0].primitives[0].mesh.normals) n = leaning(degrees);
  floor.materials = {material};
  return floor;
}

// Makes a wall at x = 1 on the floor, 2 m high, that faces -X.
bundle::MeshData wall() {
  bundle::MeshData wall;
  wall.positions = {{1, 0, -5}, {1, 0, 5}, {1, 2, 5}, {1, 2, -5}};
  wall.normals.assign(4, {-1, 0, 0});
  wall.indices = {0, 1, 2, 0, 2, 3};
  return wall;
}

// The eye is at -X, so low that a mirror with this tilt would look to +X below the floor.
constexpr float kLean = 20.0f, kEyeElevation = 25.0f, kHidden = 2 * kLean - kEyeElevation;
glm::vec3 eye() {
  return kPlace + 2.0f * spec::directionFromAzimuthElevation(-90.0f, kEyeElevation);
}
spec::SunLight sunAt(float elevation_deg) {
  return {.azimuth_deg = 90, .elevation_deg = elevation_deg, .angle_deg = 3, .radiance = glm::vec3(7)};
}

// Returns the albedo of a white metal, whose F0 and F90 are 1.
double albedo(float roughness, float lean) {
  const glm::dvec3 n(leaning(lean)), v = glm::normalize(glm::dvec3(eye() - kPlace));
  const double cosine = glm::dot(n, v), alpha = double{roughness} * double{roughness};
  const glm::dvec2 parts =
      Ggx{.alpha_t = alpha, .alpha_b = alpha}.albedo({std::sqrt(1.0 - cosine * cosine), 0.0, cosine});
  return parts.x + parts.y;
}

TEST(Horizons, ARayAboveTheTriangleStandsForTheDirectionThatItAnswers) {
  for (std::uint32_t n = 0; n < 1000; ++n) {
    const auto random = [&](float step) {
      const float x = step * static_cast<float>(n + 1);
      return sphereDirection({x - std::floor(x), 2.4f * x - std::floor(2.4f * x)});
    };
    Horizons horizons{.smooth = random(0.6180340f), .triangle = {}};
    horizons.triangle = glm::normalize(horizons.smooth + 0.5f * random(0.7548777f));
    const glm::vec3 dir = random(0.5698403f), ray = horizons.rayFor(dir);
    ASSERT_GE(glm::dot(ray, horizons.triangle), 0.0f) << n;
    float nearest = 2.0f;
    horizons.forAbove(ray, [&](const glm::vec3& above) {
      EXPECT_GT(glm::dot(above, horizons.smooth), 0.0f) << n;
      for (const glm::vec3& from : {above, Horizons::mirrored(above, horizons.smooth)})
        nearest = testing::smaller(nearest, glm::distance(from, dir));
    });
    EXPECT_LT(nearest, 1e-5f) << n;
  }
}

// Light of a local source is found both by paths and by sampling the source: it must count once in total.
TEST(LeaningNormals, ReflectAllOfWhatShinesAllAround) {
  for (const float roughness : {0.3f, 0.6f}) {
    const double expected = 2.0 * albedo(roughness, kLean);
    const spec::SphereLight around{.position_ws = {0, 3, 0}, .radius_m = 100, .radiance = glm::vec3(2)};
    Scene floor = floorThatLeans(isotropicMetal(roughness), kLean);
    const auto sphere = measured(floor, eye(), kPlace, {around}, samples(256, 0));
    EXPECT_NEAR(sphere.mean.g, expected, 4.0 * sphere.error.g + 2e-3) << roughness;
    add(floor, testing::flipped(testing::grid({0, 1, 0}, 1e3f, 1)), testing::lamp(2.0f));
    const auto ceiling = measured(floor, eye(), kPlace, {}, samples(1024, 0));
    EXPECT_NEAR(ceiling.mean.g, expected, 4.0 * ceiling.error.g + 4e-3) << roughness;
    EXPECT_LT(ceiling.error.g, 0.02) << roughness;
  }
}

TEST(LeaningNormals, ShowTheSkyOfTheHiddenDirectionItself) {
  const Scene floor = floorThatLeans(isotropicMetal(0.0f), kLean);
  EXPECT_NEAR(measured(floor, eye(), kPlace, {sunAt(-kHidden)}, samples(64)).mean.g, 7.0, 0.02);
  EXPECT_LT(measured(floor, eye(), kPlace, {sunAt(kHidden)}, samples(64)).mean.g, 0.01);
}

TEST(LeaningNormals, ShowWhatStandsInTheMirrorImage) {
  Scene lit = floorThatLeans(isotropicMetal(0.0f), kLean);
  add(lit, wall(), testing::lamp(3.0f));
  // Neither the sun behind the wall nor the one in front of the mirror image is visible.
  const auto seen = measured(lit, eye(), kPlace, {sunAt(-kHidden), sunAt(kHidden)}, samples(64, 0));
  EXPECT_NEAR(seen.mean.g, 3.0, 0.01);
}

}  // namespace
}  // namespace lambent::baker::reference
