// Compares pictures of media with closed forms.
#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "tests/reference/measure.hpp"
#include "tests/reference/media.hpp"

namespace lambent::baker::reference {
namespace {

using testing::even;
using testing::expectMean;
using testing::measured;
using testing::place;
using testing::rendered;
using testing::samples;
using testing::sceneOf;
using testing::uniform;

Scene cloud(float density, glm::vec3 albedo = glm::vec3(1), float g = 0.0f) {
  Scene scene = sceneOf({});
  place(scene, even(density, albedo, g));
  return scene;
}

// Makes a directional light of the scene, shining along `along`, with `lux` on a surface that faces it.
void shine(Scene& scene, glm::vec3 along, float lux) {
  gltf::Light light;
  light.type = gltf::Light::Type::Directional;
  light.intensity = lux;
  const glm::vec3 up = std::abs(along.y) > 0.9f ? glm::vec3(1, 0, 0) : glm::vec3(0, 1, 0);
  testing::addLight(scene, light, glm::inverse(glm::lookAt(glm::vec3(0), along, up)));
}

const glm::vec3 kFront(0.1f, 0.2f, 3.0f), kBack(0.1f, 0.2f, -1.0f);  // a ray through all of the cube, 1 m
const std::vector<spec::Light> kDark = {uniform(0.0f)};

double transmittanceOf(float density) {
  return std::exp(-double{density});
}

TEST(VolumePicture, OfABlackVolumeIsTheSkyThroughIt) {
  for (const float density : {1e-6f, 0.5f, 4.0f, 1e6f}) {
    const auto seen = measured(cloud(density, glm::vec3(0)), kFront, kBack, {uniform(2.0f)}, samples(4));
    EXPECT_NEAR(seen.mean.g, 2.0 * transmittanceOf(density), 1e-5);
    EXPECT_NEAR(seen.alpha, -std::expm1(-double{density}), 1e-6);
    if (density < 1.0f) {
      EXPECT_NEAR(seen.alpha / -std::expm1(-double{density}), 1.0, 1e-5);
    }
  }
}

TEST(VolumePicture, InAWhiteFurnaceShowsNothing) {
  // Every path with albedo 1 returns the light's radiance without noise, for any density, phase function and
  // surfaces.
  for (const float density : {1.0f, 4.0f, 16.0f})
    for (const float g : {0.0f, 0.8f}) {
      Scene scene =
          sceneOf({testing::grid({0, -0.7f, 0}, 4.0f, 1), testing::box({0.2f, 0.1f, 0}, glm::vec3(0.3f), 1)});
      place(scene, even(density, glm::vec3(1), g));
      place(scene, even(0.5f * density, glm::vec3(1), -0.5f * g, {0.3f, 0.3f, 0.2f}));
      const auto report = rendered(scene, {.lights = {uniform(1.0f)},
                                           .camera = spec::OrbitCamera{30, 20, 1.2f, 40},
                                           .options = {.size = {24, 24}, .spp = 4}});
      double covered = 0.0;
      for (const glm::vec4& texel : report.image.texels) {
        EXPECT_NEAR(texel.g, 1.0f, 2e-5f);
        covered += double{texel.w} / 576;
      }
      EXPECT_GT(covered, 0.5);
    }
}

// Returns the mean over all directions of the radiance that arrives in the middle of the cube: by symmetry,
// that over one face of a cube map. The camera is inside the volume.
glm::dvec3 meanInTheMiddle(const Scene& medium, std::uint32_t spp) {
  Scene scene = medium;
  testing::lookAt(scene, {0, 0, 0}, {0, 0, -1}, 90.0f);
  const auto report =
      rendered(scene, {.lights = {uniform(1.0f)}, .camera = {}, .options = {.size = {32, 32}, .spp = spp}});
  glm::dvec3 sum(0.0);
  double angle = 0.0;
  for (std::size_t i = 0; i < 1024; ++i) {
    const double u = (static_cast<double>(i % 32) + 0.5) / 16 - 1,
                 v = (static_cast<double>(i / 32) + 0.5) / 16 - 1;
    const double weight = std::pow(1 + u * u + v * v, -1.5);
    sum += weight * glm::dvec3(report.image.texels[i]);
    angle += weight;
  }
  return sum / angle;
}

TEST(VolumePicture, ScattersInACubeAsTheTableSays) {
  // The values are from literature 7.8, for albedo 0.5, 0.9 and 1, exact to 0.001.
  const std::pair<float, glm::dvec3> table[] = {
      {1.0f, {0.716, 0.930, 1.0}}, {4.0f, {0.210, 0.651, 1.0}}, {16.0f, {0.0007, 0.052, 1.0}}};
  for (const auto& [density, expected] : table) {
    const glm::dvec3 seen = meanInTheMiddle(cloud(density, {0.5f, 0.9f, 1.0f}), density > 10.0f ? 32 : 128);
    // These are 30,000 and 130,000 paths.
    const double noise = density > 10.0f ? 0.003 : 0.0025;
    EXPECT_NEAR(seen.r, expected.r, noise) << density;
    EXPECT_NEAR(seen.g, expected.g, noise) << density;
    EXPECT_NEAR(seen.b, expected.b, 2e-5) << density;
  }
}

TEST(VolumePicture, OfSingleScatteringIsItsClosedForm) {
  // --bounces 0. Light from above reaches a ray at depth d = 0.5 - y alike all along: E p(0) exp(-s d)
  // (1 - exp(-s)). From behind, each of its points has exp(-s) in all before and behind it: E p(1) s exp(-s);
  // from before the eye, E p(-1) (1 - exp(-2 s)) / 2.
  const float y = 0.2f;
  for (const float density : {0.01f, 1.0f, 5.0f})
    for (const float g : {0.0f, 0.6f, -0.4f}) {
      const double s = double{density}, k = double{g};
      const auto phase = [&](double c) {
        return (1 - k * k) / (4 * std::numbers::pi * std::pow(1 + k * k - 2 * k * c, 1.5));
      };
      const auto seen = [&](glm::vec3 along) {
        Scene scene = cloud(density, {1, 0.5f, 0.25f}, g);
        shine(scene, along, 10.0f);
        return measured(scene, {0.1f, y, 3.0f}, {0.1f, y, -1.0f}, kDark, samples(256, 0));
      };
      const auto above = seen({0, -1, 0}), behind = seen({0, 0, 1}), before = seen({0, 0, -1});
      expectMean(above, 5.0 * phase(0) * std::exp(-s * (0.5 - 0.2)) * -std::expm1(-s));
      expectMean(behind, 5.0 * phase(1) * s * std::exp(-s));
      expectMean(before, 5.0 * phase(-1) * -std::expm1(-2 * s) / 2);
      EXPECT_NEAR(above.mean.r, 2.0 * above.mean.g, 1e-5 * above.mean.r);
      EXPECT_NEAR(above.mean.b, 0.5 * above.mean.g, 1e-5 * above.mean.r);
      EXPECT_LT(above.error.g, 0.01 * above.mean.g) << density;
    }
}

TEST(VolumePicture, ThinIsTheLightConvolvedWithThePhaseFunction) {
  // One scattering and no loss: towards d goes Σ g^l L_lm y_lm(d), of light that is cut to five bands. With
  // OUT bands of the phase function the sum ends there.
  const spec::SunLight sun{
      .azimuth_deg = 30, .elevation_deg = 20, .angle_deg = 8, .radiance = glm::vec3(100)};
  const auto light = spec::loadDistantLights({sun})->lightVector();
  const float density = 1e-3f;
  for (const float g : {0.0f, 0.6f})
    for (const auto& out : {std::optional<int>(), std::optional(3)}) {
      // Towards the light, and away from it.
      for (const glm::vec3 along :
           {glm::normalize(glm::vec3(0.5f, 0.2f, 1)), glm::normalize(glm::vec3(-0.3f, -0.4f, -1))}) {
        double expected = 0.0;
        std::array<float, sh::kMaxCoefficients> y{};
        sh::evaluate(5, along, std::span(y));
        for (int l = 0; l < out.value_or(5); ++l)
          for (int i = l * l; i < (l + 1) * (l + 1); ++i)
            expected += std::pow(double{g}, l) * double{light.c[static_cast<std::size_t>(i)].g} *
                        double{y[static_cast<std::size_t>(i)]};
        Options options = samples(1024, 0);
        options.band_limit = BandLimit{5, out};
        const auto seen = measured(cloud(density, glm::vec3(1), g), -3.0f * along, {0, 0, 0}, {sun}, options);
        expectMean({.mean = seen.mean / seen.alpha, .error = seen.error / seen.alpha}, expected, 3e-3);
        EXPECT_LT(seen.error.g / seen.alpha, 0.02 * std::abs(expected) + 0.01);
      }
    }
}

TEST(VolumePicture, ShadesTheGroundByItsOpticalDepth) {
  // The sun is straight above a sheet over the ground: exp(-depth) of its light passes.
  for (const float density : {0.5f, 3.0f}) {
    Scene scene = sceneOf({testing::grid({0, 0, 0}, 4.0f, 1)});
    place(scene, even(density, glm::vec3(0), 0, {0, 1, 0}, {3, 1, 3}));
    const spec::SunLight sun{.elevation_deg = 90, .angle_deg = 2, .radiance = glm::vec3(1000)};
    const double open = 1000.0 * std::pow(std::sin(2.0 * std::numbers::pi / 180), 2.0);
    const auto seen = measured(scene, {0, 0.3f, 0.8f}, {0.1f, 0, 0.1f}, {sun}, samples(256));
    expectMean(seen, open * transmittanceOf(density), 1e-3);
    EXPECT_EQ(seen.alpha, 1.0);
    // A lamp is in it, too, a metre above the ground.
    shine(scene, {0, -1, 0}, 3.0f);
    expectMean(measured(scene, {0, 0.3f, 0.8f}, {0.1f, 0, 0.1f}, kDark, samples(256)),
               3.0 / std::numbers::pi * transmittanceOf(density));
  }
}

TEST(VolumePicture, ShowsSurfacesThroughItAndFromWithin) {
  // An emissive wall is behind half a metre of a black medium.
  Scene scene = sceneOf({testing::box({0, 0, -1}, {3, 3, 2}, 1)});
  scene.materials[0].emissive = glm::vec3(2);
  scene.materials[0].base_color = glm::vec4(0, 0, 0, 1);
  place(scene, even(2.0f, glm::vec3(0)));
  const auto from_outside = measured(scene, kFront, kBack, kDark, samples(4));
  EXPECT_NEAR(from_outside.mean.g, 2.0 * std::exp(-1.0), 1e-5);
  EXPECT_EQ(from_outside.alpha, 1.0);
  // The near plane is a millimetre or so in front of a camera that is inside.
  const auto from_within = measured(scene, {0, 0, 0.25f}, {0, 0, -1}, kDark, samples(4));
  EXPECT_NEAR(from_within.mean.g, 2.0 * std::exp(-0.5), 3e-3);
  const auto away = measured(scene, {0, 0, 0.25f}, {0, 0, 3}, kDark, samples(4));
  EXPECT_NEAR(away.alpha, 1.0 - std::exp(-0.5), 2e-3);
}

TEST(VolumePicture, OfTwoThatOverlapIsThatOfTheirSum) {
  // If a medium of albedo 1 and one twice as dense of albedo 0.4 overlap, the albedo is 0.6.
  Scene two = cloud(1.0f, glm::vec3(1));
  place(two, even(2.0f, glm::vec3(0.4f)));
  const spec::SunLight sun{.azimuth_deg = 60, .elevation_deg = 40, .angle_deg = 30, .radiance = glm::vec3(1)};
  const auto a = measured(two, kFront, kBack, {sun, uniform(0.2f)}, samples(512));
  const auto b = measured(cloud(3.0f, glm::vec3(0.6f)), kFront, kBack, {sun, uniform(0.2f)}, samples(512));
  EXPECT_NEAR(a.mean.g, b.mean.g, 4.0 * std::hypot(a.error.g, b.error.g));
  EXPECT_LT(a.error.g, 0.005 * a.mean.g);
  EXPECT_NEAR(a.alpha, b.alpha, 1e-6);
}

TEST(VolumePicture, InHardCasesStaysFinite) {
  Request request{
      .lights = {uniform(0.3f),
                 spec::SunLight{.elevation_deg = 50, .angle_deg = 3, .radiance = glm::vec3(1e4f)},
                 spec::SphereLight{
                     .position_ws = {0.1f, 0.1f, 0.1f}, .radius_m = 1e-4f, .radiance = glm::vec3(1e6f)}},
      .camera = spec::OrbitCamera{30, 20, 1.1f, 40},
      .options = {.size = {12, 12}, .spp = 8}};
  for (const float density : {1e-30f, 1e-6f, 1e6f, 1e25f})
    for (const float g : {0.0f, 0.999f, -0.999f})
      for (const auto& limit : {std::optional<BandLimit>(), std::optional(BandLimit{5, 5})}) {
        request.options.band_limit = limit;
        Scene scene = sceneOf({testing::grid({0, 0, 0}, 0.8f, 1)});
        place(scene, even(density, glm::vec3(0.9f, 0.5f, 0.0f), g));
        for (const glm::vec4& texel : rendered(scene, request).image.texels)
          EXPECT_TRUE(std::isfinite(texel.r + texel.g + texel.b) && texel.w >= 0.0f && texel.w <= 1.0f)
              << density;
      }
}

}  // namespace
}  // namespace lambent::baker::reference
