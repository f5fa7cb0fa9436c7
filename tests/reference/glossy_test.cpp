// Compares pictures of surfaces that are not Lambert with closed forms and quadrature, with the whole BRDF
// and with the band-limited kernel of the first hit.
#include <gtest/gtest.h>

#include "reference/exit_kernel.hpp"
#include "reference/sampler.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "tests/reference/measure.hpp"
#include "tests/reference/quadrature.hpp"

namespace lambent::baker::reference {
namespace {

using testing::Ggx;
using testing::kPlace;
using testing::limited;
using testing::measured;
using testing::samples;
using testing::sceneOf;

struct Sample {
  const char* name;
  gltf::Material material;
};

gltf::Material glossy(float metallic, float roughness, float anisotropy = 0.0f) {
  gltf::Material material;
  material.metallic = metallic;
  material.roughness = roughness;
  material.anisotropy = anisotropy;
  material.base_color = glm::vec4(0.9f, 0.6f, 0.3f, 1.0f);
  return material;
}

Scene glossyFloor(const gltf::Material& material, float width = 4.0f) {
  Scene scene = sceneOf({testing::grid({0, 0, 0}, width, 1)});
  auto& mesh = scene.meshes[0].primitives[0].mesh;
  mesh.tangents.assign(mesh.positions.size(), glm::vec4(1, 0, 0, 1));
  scene.materials = {material};
  return scene;
}

glm::vec3 eyeAt(float elevation_deg, float azimuth_deg) {
  return kPlace + 2.0f * spec::directionFromAzimuthElevation(azimuth_deg, elevation_deg);
}

// The floor's frame has x along +X, y along -Z, z up; its tangent is along x.
glm::dvec3 toLocal(const glm::dvec3& world) {
  return {world.x, -world.z, world.y};
}
glm::dvec3 toWorld(const glm::dvec3& local) {
  return {local.x, local.z, -local.y};
}

// Computes c_k of the floor over a grid of half vectors, in double, for materials without textures and with
// ior 1.5.
sh::LightVector kernelOf(const gltf::Material& material, const glm::vec3& to_eye, int order) {
  const double alpha = std::max(1e-3, double{material.roughness} * double{material.roughness});
  const double strength = double{material.anisotropy};
  const Ggx lobe{.alpha_t = std::lerp(alpha, 1.0, strength * strength), .alpha_b = alpha};
  const glm::dvec3 v = toLocal(glm::dvec3(to_eye)), base(material.base_color);
  const double metal = double{material.metallic};
  const glm::dvec3 f0 = glm::mix(glm::dvec3(0.04), base, metal);
  std::array<glm::dvec3, sh::kMaxCoefficients> sums{};
  std::array<double, sh::kMaxCoefficients> y{};
  glm::dvec3 albedo(0.0);
  lobe.integrate(
      v,
      [&](const glm::dvec3& s, double weight) {
        if (s.z <= 0.0) return;
        const glm::dvec2 parts = lobe.value(v, s) * (s.z * weight);
        const glm::dvec3 value = f0 * parts.x + parts.y;
        albedo += value;
        sh::evaluate(order, toWorld(s), y);
        for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += value * y[k];
      },
      200);
  std::array<float, sh::kMaxCoefficients> cosine{};
  sh::unoccludedTransfer(order, glm::vec3(0, 1, 0), cosine);
  const glm::dvec3 diffuse = (1.0 - metal) * (1.0 - std::max({albedo.r, albedo.g, albedo.b})) * base;
  sh::LightVector out{.order = order};
  for (std::size_t k = 0; k < out.coefficients().size(); ++k)
    out.c[k] = glm::vec3(sums[k] + diffuse * double{cosine[k]});
  return out;
}

glm::dvec3 dot(const sh::LightVector& a, const sh::LightVector& b) {
  glm::dvec3 sum(0.0);
  for (std::size_t k = 0; k < a.c.size(); ++k) sum += glm::dvec3(a.c[k]) * glm::dvec3(b.c[k]);
  return sum;
}

const spec::SunLight kSun{
    .azimuth_deg = 200, .elevation_deg = 40, .angle_deg = 8, .radiance = glm::vec3(100)};

const std::vector<Sample> kSamples = {{"metal 0.3", glossy(1.0f, 0.3f)},
                                      {"metal 0.8", glossy(1.0f, 0.8f)},
                                      {"dielectric 0.2", glossy(0.0f, 0.2f)},
                                      {"dielectric 0.6", glossy(0.0f, 0.6f)},
                                      {"anisotropic 0.3", glossy(1.0f, 0.3f, 0.7f)},
                                      {"anisotropic dielectric", glossy(0.0f, 0.3f, 0.8f)}};

TEST(Glossy, KernelTimesLightIsWhatAnOpenFloorShows) {
  const auto light = spec::loadDistantLights({kSun})->lightVector();
  for (const Sample& sample : kSamples)
    for (const float elevation : {80.0f, 30.0f, 6.0f})
      for (const int order : {3, 5}) {
        const glm::vec3 eye = eyeAt(elevation, 25.0f);
        const sh::LightVector kernel = kernelOf(sample.material, glm::normalize(eye - kPlace), order);
        const auto seen = measured(glossyFloor(sample.material), eye, kPlace, {kSun}, limited(4, 5, order));
        const glm::dvec3 expected = dot(kernel, light.truncated(order));
        for (int c = 0; c < 3; ++c)
          EXPECT_NEAR(seen.mean[c], expected[c], 0.004 * std::max(0.2, std::abs(expected[c])))
              << sample.name << " " << elevation << " " << order;
        EXPECT_LT(seen.error.g, 0.003 * std::max(0.2, std::abs(expected.g))) << sample.name;
      }
}

TEST(Glossy, WholePicturesOfASunAreWhatQuadratureSays) {
  // The sun is wide enough for the grid of directions over it. All sampling strategies are used.
  const spec::SunLight sun{
      .azimuth_deg = 205, .elevation_deg = 40, .angle_deg = 10, .radiance = glm::vec3(30)};
  const glm::mat3 frame = frameAbout(spec::directionFromAzimuthElevation(sun.azimuth_deg, sun.elevation_deg));
  for (const Sample& sample : kSamples) {
    if (sample.material.metallic < 1.0f) continue;
    const glm::vec3 eye = eyeAt(35.0f, 25.0f);
    const glm::dvec3 v = toLocal(glm::dvec3(glm::normalize(eye - kPlace)));
    const double alpha = double{sample.material.roughness} * double{sample.material.roughness};
    const double strength = double{sample.material.anisotropy};
    const Ggx lobe{.alpha_t = std::lerp(alpha, 1.0, strength * strength), .alpha_b = alpha};
    const double half = std::sin(glm::radians(5.0)), cap = 2.0 * half * half;
    constexpr int kCount = 200;
    glm::dvec3 expected(0.0);
    for (int i = 0; i < kCount; ++i)
      for (int j = 0; j < kCount; ++j) {
        const glm::vec3 dir = frame * coneDirection({(static_cast<float>(i) + 0.5f) / kCount,
                                                     (static_cast<float>(j) + 0.5f) / kCount},
                                                    static_cast<float>(cap));
        const glm::dvec3 s = toLocal(glm::dvec3(dir));
        const glm::dvec2 parts = lobe.value(v, s) * s.z;
        expected += 30.0 * (glm::dvec3(sample.material.base_color) * parts.x + parts.y) *
                    (2.0 * std::numbers::pi * cap / (kCount * kCount));
      }
    const auto seen = measured(glossyFloor(sample.material), eye, kPlace, {sun}, samples(256));
    for (int c = 0; c < 3; ++c)
      EXPECT_NEAR(seen.mean[c], expected[c], 4.0 * seen.error[c] + 1e-3 * expected[c]) << sample.name;
    EXPECT_LT(seen.error.g, 0.01 * expected.g) << sample.name;
  }
}

// Makes a floor and a ceiling so wide that it hides the sky.
Scene underCeiling(const gltf::Material& floor, const gltf::Material& ceiling) {
  Scene scene = glossyFloor(floor);
  testing::add(scene, testing::flipped(testing::grid({0, 1, 0}, 1e3f, 1)), ceiling);
  return scene;
}

TEST(Glossy, LimitedKernelsSeeAClosedSkyAboveAndBelow) {
  // The ceiling hides the sky, also for the mirrored directions below the floor, although the kernel is not
  // zero there. An emissive ceiling is uniform light.
  const glm::vec3 eye = kPlace + glm::vec3(0.3f, 0.4f, 0.2f);
  for (const Sample& sample : kSamples) {
    const auto dark = measured(underCeiling(sample.material, testing::matte(0.0f)), eye, kPlace, {kSun},
                               limited(1024, 5, 5));
    EXPECT_LT(std::abs(dark.mean.g), 4.0 * dark.error.g + 1e-3) << sample.name;
    EXPECT_LT(dark.error.g, 0.01) << sample.name;
    EXPECT_EQ(dark.alpha, 1.0);
    EXPECT_GT(dark.error.g, 0.0) << sample.name;
    const auto bright =
        measured(underCeiling(sample.material, testing::lamp(2.0f)), eye, kPlace, {}, limited(1024, 5, 5));
    const sh::LightVector kernel = kernelOf(sample.material, glm::normalize(eye - kPlace), 1);
    const double expected = 2.0 * std::sqrt(4.0 * std::numbers::pi) * double{kernel.c[0].g};
    EXPECT_NEAR(bright.mean.g, expected, 4.0 * bright.error.g + 3e-3 * expected) << sample.name;
  }
}

// Makes a black wall that covers all directions with x < 0.
void addWall(Scene& scene) {
  bundle::MeshData wall;
  wall.positions = {{0, -1, -500.0f}, {0, 500.0f, -500.0f}, {0, 500.0f, 500.0f}, {0, -1, 500.0f}};
  wall.normals.assign(4, {1, 0, 0});
  wall.indices = {0, 1, 2, 0, 2, 3};
  gltf::Material black = testing::matte(0.0f);
  black.double_sided = true;
  testing::add(scene, wall, black);
}

// Returns the radiance that a kernel gets from the sun's five bands in the directions that `open` admits.
template <typename Open>
double received(const sh::LightVector& kernel, const Open& open) {
  const auto light = spec::loadDistantLights({kSun})->lightVector().truncated(5);
  constexpr int kRows = 400, kColumns = 800;
  double sum = 0.0;
  for (int r = 0; r < kRows; ++r)
    for (int c = 0; c < kColumns; ++c) {
      const glm::vec3 s = sphereDirection(
          {(static_cast<float>(r) + 0.5f) / kRows, (static_cast<float>(c) + 0.5f) / kColumns});
      if (open(s))
        sum += double{kernel.evaluate(s).g} * double{light.evaluate(s).g} * 4.0 * std::numbers::pi /
               (kRows * kColumns);
    }
  return sum;
}

TEST(Glossy, LimitedKernelsMirrorWhatLiesBelowSmoothNormalsInThem) {
  // Bundles' surfaces may have such normals. Above a tilted normal, all directions that do not point to the
  // wall are open, also those below the floor, whose mirror images do not point to it either.
  for (const float lean : {0.4f, -0.4f}) {
    Scene scene = glossyFloor(glossy(1.0f, 0.5f));
    const glm::vec3 normal = glm::normalize(glm::vec3(lean, 1.0f, 0.0f));
    for (glm::vec3& n : scene.meshes[0].primitives[0].mesh.normals) n = normal;
    addWall(scene);
    // The camera is near the sun's mirror image.
    const glm::vec3 eye = kPlace + glm::vec3(0.4f, 1.0f, 1.0f);
    SurfacePoint point;
    point.shading = normal;
    point.glossy = true;
    point.reflector.world_from_local = frameAbout(normal);
    point.reflector.view = point.reflector.toLocal(glm::normalize(eye - kPlace));
    point.reflector.f0 = glm::vec3(glossy(1.0f, 0.5f).base_color);
    point.reflector.f90 = 1.0f;
    point.reflector.alpha = ggxAlpha(0.5f, 0.0f);
    const double expected = received(exitKernel(point, 5, 1, 1 << 16), [&](const glm::vec3& s) {
      const float height = glm::dot(s, normal);
      return (height < 0.0f ? s - 2.0f * height * normal : s).x > 0.0f;
    });
    const auto seen = measured(scene, eye, kPlace, {kSun}, limited(1024, 5, 5));
    EXPECT_NEAR(seen.mean.g, expected, 4.0 * seen.error.g + 4e-3 * std::abs(expected)) << lean;
    EXPECT_LT(seen.error.g, 0.05 * std::abs(expected)) << lean;
  }
}

TEST(Glossy, StaysFiniteInHardPlaces) {
  for (const float roughness : {0.0f, 1.0f})
    for (const float anisotropy : {0.0f, 1.0f}) {
      Scene scene = glossyFloor(glossy(0.5f, roughness, anisotropy));
      scene.meshes[0].primitives[0].mesh.tangents.clear();
      for (const float elevation : {90.0f, 0.05f})
        for (const bool cut : {false, true}) {
          Options options = cut ? limited(16, 5, 5) : samples(16);
          options.bounces = 3;
          const auto seen =
              measured(scene, eyeAt(elevation, 10), kPlace,
                       {spec::SunLight{.elevation_deg = 90, .angle_deg = 0.01f, .radiance = glm::vec3(1e6f)}},
                       options);
          EXPECT_TRUE(std::isfinite(seen.mean.g)) << roughness << " " << elevation;
        }
    }
}

}  // namespace
}  // namespace lambent::baker::reference
