#include "runtime/lighting/key_lights.hpp"

#include <cmath>
#include <cstddef>
#include <filesystem>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/sh/basis.hpp"
#include "runtime/sh/image_layout.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::lighting {

namespace {

using sh::kPi;

double luminance(const glm::vec3& c) {
  return 0.2126 * static_cast<double>(c.r) + 0.7152 * static_cast<double>(c.g) +
         0.0722 * static_cast<double>(c.b);
}

double solidAngle(const spec::Disc& disc) {
  return 2 * kPi * (1 - std::cos(static_cast<double>(disc.radius_rad)));
}

// Makes an environment map of radianceAt(direction), black outside the layout.
template <typename RadianceAt>
spec::EnvironmentMap painted(sh::ImageLayout layout, int width, int height, RadianceAt&& radianceAt) {
  spec::EnvironmentMap environment_map{
      .image = {static_cast<std::uint32_t>(width), static_cast<std::uint32_t>(height), {}}, .layout = layout};
  for (int y = 0; y < height; ++y)
    for (int x = 0; x < width; ++x) {
      const glm::dvec3 dir = sh::texelDirection(layout, width, height, x, y);
      environment_map.image.texels.push_back(dir == glm::dvec3(0.0) ? glm::vec3(0.0f) : radianceAt(dir));
    }
  return environment_map;
}

// This sky is bluer above, and has nothing in bands 2 and up.
glm::vec3 smoothSky(const glm::dvec3& dir) {
  return glm::vec3(1.0f, 1.2f, 1.5f) * static_cast<float>(1.0 + 0.4 * dir.y + 0.2 * dir.x);
}

const glm::dvec3 kSun = glm::normalize(glm::dvec3(0.4, 0.7, -0.3));
constexpr double kSunRadius = 0.02;

glm::vec3 skyWithSun(const glm::dvec3& dir) {
  const bool in_sun = glm::distance(dir, kSun) < kSunRadius;
  return smoothSky(dir) + (in_sun ? glm::vec3(9000.0f, 8000.0f, 6000.0f) : glm::vec3(0.0f));
}

spec::DistantLights oneMap(spec::EnvironmentMap environment_map) {
  spec::DistantLights lights;
  lights.environment_maps.push_back(std::move(environment_map));
  return lights;
}

spec::DistantLights skyAndDisc(double radius_deg, float radiance) {
  spec::DistantLights lights;
  lights.constant = glm::vec3(1.0f);
  lights.discs.push_back({.direction = glm::vec3(glm::normalize(glm::dvec3(0.3, 0.8, 0.5))),
                          .radius_rad = static_cast<float>(radius_deg * kPi / 180),
                          .radiance = radiance * glm::vec3(1.0f, 0.9f, 0.7f)});
  return lights;
}

sh::LightVector total(const spec::DistantLights& lights, const PartedLights& parted) {
  sh::LightVector light = sh::constantLight(2, lights.constant);
  for (const auto* discs : {&parted.keys, &parted.discs})
    for (const spec::Disc& disc : *discs)
      light += sh::discLight(2, disc.direction, static_cast<double>(disc.radius_rad), disc.radiance);
  for (std::size_t k = 0; k < lights.environment_maps.size(); ++k) {
    const spec::EnvironmentMap& environment_map =
        parted.environment_maps[k] ? *parted.environment_maps[k] : lights.environment_maps[k];
    light += sh::projectImage(2, environment_map.layout, static_cast<int>(environment_map.image.width),
                              static_cast<int>(environment_map.image.height), environment_map.image.texels);
  }
  return light;
}

// Band 0 of keys and rest equals that of the whole up to rounding. Band 1 differs by more, because a key has
// one direction for all channels, and is no smaller than a texel.
void expectEnergyConserved(const spec::DistantLights& lights, const PartedLights& parted,
                           float band_1_tolerance) {
  const sh::LightVector after = total(lights, parted);
  sh::LightVector before = lights.lightVector();
  for (std::size_t i = 0; i < 4; ++i)
    for (int channel = 0; channel < 3; ++channel)
      EXPECT_NEAR(after.c[i][channel], before.c[i][channel],
                  before.c[0][channel] * (i == 0 ? 1e-4f : band_1_tolerance))
          << "coefficient " << i << ", channel " << channel;
}

void expectSane(const PartedLights& parted) {
  for (const spec::Disc& key : parted.keys) {
    EXPECT_NEAR(glm::length(key.direction), 1.0f, 1e-5f);
    EXPECT_GT(key.radius_rad, 0.0f);
    EXPECT_LT(key.radius_rad, 4.0f);
    for (int channel = 0; channel < 3; ++channel) EXPECT_TRUE(std::isfinite(key.radiance[channel]));
  }
  for (const auto& environment_map : parted.environment_maps) {
    if (!environment_map) continue;
    for (const glm::vec3& texel : environment_map->image.texels) {
      const bool finite = std::isfinite(texel.r) && std::isfinite(texel.g) && std::isfinite(texel.b);
      ASSERT_TRUE(finite);
    }
  }
}

}  // namespace

TEST(KeyLights, SmoothLightHasNoneAndNothingIsCopied) {
  for (const spec::EnvironmentMap& environment_map :
       {painted(sh::ImageLayout::LatLong, 256, 128, smoothSky),
        painted(sh::ImageLayout::LatLong, 16, 8, [](const glm::dvec3&) { return glm::vec3(2.0f); }),
        painted(sh::ImageLayout::AngularMap, 128, 128, smoothSky),
        painted(sh::ImageLayout::VerticalCross, 96, 128, smoothSky)}) {
    const PartedLights parted = partLights(oneMap(environment_map));
    EXPECT_TRUE(parted.keys.empty());
    ASSERT_EQ(parted.environment_maps.size(), 1u);
    EXPECT_FALSE(parted.environment_maps[0].has_value());
    EXPECT_LT(parted.loss_before, 0.01);
    EXPECT_EQ(parted.loss_after, parted.loss_before);
  }
}

TEST(KeyLights, FindsTheSunOfAPictureInEveryLayout) {
  struct Picture {
    sh::ImageLayout layout;
    int width, height;
    double texel_rad;
  };
  for (const auto& [layout, width, height, texel_rad] :
       {Picture{sh::ImageLayout::LatLong, 1024, 512, 2 * kPi / 1024},
        Picture{sh::ImageLayout::AngularMap, 512, 512, 2 * kPi / 512},
        Picture{sh::ImageLayout::VerticalCross, 768, 1024, kPi / 2 / 256}}) {
    SCOPED_TRACE(sh::name(layout));
    const spec::DistantLights lights = oneMap(painted(layout, width, height, skyWithSun));
    const PartedLights parted = partLights(lights);
    ASSERT_EQ(parted.keys.size(), 1u);
    const spec::Disc& key = parted.keys[0];
    EXPECT_LT(glm::distance(glm::dvec3(key.direction), kSun), texel_rad);
    EXPECT_NEAR(static_cast<double>(key.radius_rad), kSunRadius, texel_rad);
    // The painted flux is measured without the rim's texels: the sun is about 7 texels wide.
    double painted_flux = 0.0;
    ASSERT_TRUE(parted.environment_maps[0]);
    for (int y = 0; y < height; ++y)
      for (int x = 0; x < width; ++x) {
        const auto i = static_cast<std::size_t>(y * width + x);
        const glm::dvec3 dir = sh::texelDirection(layout, width, height, x, y);
        if (dir == glm::dvec3(0.0)) continue;
        painted_flux +=
            sh::texelSolidAngle(layout, width, height, x, y) * luminance(skyWithSun(dir) - smoothSky(dir));
        // The rest is the sky, with at most a dim patch where the sun was.
        if (glm::distance(dir, kSun) >= kSunRadius) {
          ASSERT_EQ(parted.environment_maps[0]->image.texels[i], lights.environment_maps[0].image.texels[i]);
        } else {
          ASSERT_NEAR(luminance(parted.environment_maps[0]->image.texels[i]),
                      static_cast<double>(parted.threshold), 1e-3 * static_cast<double>(parted.threshold));
        }
      }
    const double found = luminance(key.radiance) * solidAngle(key);
    EXPECT_LE(found, painted_flux * 1.001);
    EXPECT_GT(found, painted_flux * 0.95);
    EXPECT_GT(parted.loss_before, 0.1);
    EXPECT_LE(parted.loss_after, 0.01);
    expectEnergyConserved(lights, parted, 1e-4f);
  }
}

TEST(KeyLights, ATurnedPictureHasTheSameKeysTurned) {
  const auto lamps = [](const glm::dvec3& dir) {
    glm::vec3 light = smoothSky(dir);
    if (glm::distance(dir, kSun) < 0.05) light += glm::vec3(300.0f, 250.0f, 200.0f);
    if (glm::distance(dir, glm::normalize(glm::dvec3(-1, 0.1, 0.5))) < 0.1)
      light += glm::vec3(20.0f, 60.0f, 90.0f);
    return light;
  };
  const int width = 512, columns = 100;
  spec::EnvironmentMap environment_map = painted(sh::ImageLayout::LatLong, width, width / 2, lamps);
  const PartedLights straight = partLights(oneMap(environment_map));
  spec::EnvironmentMap moved = environment_map;
  for (int y = 0; y < width / 2; ++y)
    for (int x = 0; x < width; ++x)
      moved.image.texels[static_cast<std::size_t>(y * width + (x + columns) % width)] =
          environment_map.image.texels[static_cast<std::size_t>(y * width + x)];
  const PartedLights turned = partLights(oneMap(moved));
  ASSERT_EQ(straight.keys.size(), 2u);
  ASSERT_EQ(turned.keys.size(), 2u);
  const double angle = 2 * kPi * columns / width, c = std::cos(angle), s = std::sin(angle);
  for (std::size_t i = 0; i < 2; ++i) {
    const glm::dvec3 from(straight.keys[i].direction);
    const glm::dvec3 expected(c * from.x - s * from.z, from.y, s * from.x + c * from.z);
    EXPECT_LT(glm::distance(glm::dvec3(turned.keys[i].direction), expected), 1e-3);
    EXPECT_NEAR(turned.keys[i].radius_rad, straight.keys[i].radius_rad, 1e-3f);
    EXPECT_NEAR(luminance(turned.keys[i].radiance), luminance(straight.keys[i].radiance),
                0.01 * luminance(straight.keys[i].radiance));
  }
}

// The map has forty lamps of about the same flux.
TEST(KeyLights, ThereAreNeverMoreThanAskedFor) {
  const auto lamps = [](const glm::dvec3& dir) {
    glm::vec3 light(0.1f);
    for (int i = 0; i < 40; ++i) {
      const double y = 1 - (2.0 * i + 1) / 40, side = std::sqrt(1 - y * y), angle = 2.399963 * i;
      if (glm::distance(dir, {side * std::cos(angle), y, side * std::sin(angle)}) < 0.03)
        light += glm::vec3(50.0f);
    }
    return light;
  };
  const spec::DistantLights lights = oneMap(painted(sh::ImageLayout::LatLong, 512, 256, lamps));
  for (const std::uint32_t most : {0u, 1u, 4u, 16u, 64u}) {
    const PartedLights parted = partLights(lights, {.most = most, .least_loss = 0.001});
    EXPECT_LE(parted.keys.size(), most);
    EXPECT_LE(parted.loss_after, parted.loss_before);
    expectEnergyConserved(lights, parted, 1e-4f);
  }
  EXPECT_EQ(partLights(lights, {.most = 64, .least_loss = 0.001}).keys.size(), 40u);
}

TEST(KeyLights, AnalyticSunsAreKeysAsTheyAreAndWideOnesAreDivided) {
  for (const double radius_deg : {0.27, 2.0, 10.0, 30.0}) {
    SCOPED_TRACE(radius_deg);
    // All discs have the same flux.
    const double sr = 2 * kPi * (1 - std::cos(radius_deg * kPi / 180));
    const spec::DistantLights lights = skyAndDisc(radius_deg, static_cast<float>(30.0 / sr));
    const PartedLights parted = partLights(lights);
    EXPECT_LE(parted.loss_after, 0.01);
    EXPECT_TRUE(parted.discs.empty());
    if (radius_deg < 8.0) {
      ASSERT_EQ(parted.keys.size(), 1u);
      EXPECT_EQ(parted.keys[0].radius_rad, lights.discs[0].radius_rad);
      EXPECT_EQ(parted.keys[0].radiance, lights.discs[0].radiance);
    } else {
      EXPECT_GE(parted.keys.size(), 3u);
      EXPECT_LE(parted.keys.size(), 16u);
    }
    expectEnergyConserved(lights, parted, 2e-4f);
  }
}

TEST(KeyLights, SurvivesBlackNegativeAndEmptyLight) {
  EXPECT_TRUE(partLights({}).keys.empty());
  const auto all = [](float value) {
    return oneMap(
        painted(sh::ImageLayout::LatLong, 64, 32, [=](const glm::dvec3&) { return glm::vec3(value); }));
  };
  for (const float value : {0.0f, -1.0f}) EXPECT_TRUE(partLights(all(value)).keys.empty());
  spec::DistantLights odd = oneMap(painted(sh::ImageLayout::LatLong, 128, 64, skyWithSun));
  for (std::size_t i = 0; i < odd.environment_maps[0].image.texels.size(); i += 7)
    odd.environment_maps[0].image.texels[i] = glm::vec3(-0.1f);
  odd.environment_maps[0].image.texels[1000] = glm::vec3(-20.0f, 40000.0f, -1.0f);
  odd.environment_maps[0].image.texels[5000] = glm::vec3(1e30f);
  odd.discs.push_back({.direction = {0.0f, 1.0f, 0.0f}, .radius_rad = 0.0f, .radiance = glm::vec3(1.0f)});
  expectSane(partLights(odd));
  odd.environment_maps[0].image.texels[5000] = glm::vec3(1.0f);
  const PartedLights parted = partLights(odd);
  expectSane(parted);
  expectEnergyConserved(odd, parted, 1e-3f);
  for (const spec::Disc& key : parted.keys)
    for (int channel = 0; channel < 3; ++channel) EXPECT_GE(key.radiance[channel], 0.0f);
}

TEST(KeyLights, FindsTheNoonSunOfAPhotograph) {
  const std::filesystem::path file = testing::sharedFile("probes/noon_grass_1k.hdr");
  LAMBENT_NEEDS_SHARED(file);
  const auto environment_map = spec::loadEnvironmentMap({file, std::nullopt});
  ASSERT_TRUE(environment_map);
  const spec::DistantLights lights = oneMap(*environment_map);
  const PartedLights parted = partLights(lights);
  ASSERT_EQ(parted.keys.size(), 1u);
  EXPECT_GT(parted.keys[0].direction.y, 0.99f);
  EXPECT_LT(parted.keys[0].radius_rad, 0.01f) << "a sun and the blur of a texel";
  EXPECT_GT(parted.loss_before, 0.3);
  EXPECT_LE(parted.loss_after, 0.01);
  expectEnergyConserved(lights, parted, 1e-4f);
}

TEST(KeyLights, SixteenDiscsDoMostForAChurchAndForAStreet) {
  for (const char* name : {"probes/stpeters_cross.hdr", "probes/grace_probe.hdr",
                           "probes/uffizi_latlong_small.hdr", "probes/leadenhall_market_1k.hdr"}) {
    SCOPED_TRACE(name);
    const std::filesystem::path file = testing::sharedFile(name);
    LAMBENT_NEEDS_SHARED(file);
    const auto environment_map = spec::loadEnvironmentMap({file, std::nullopt});
    ASSERT_TRUE(environment_map);
    const spec::DistantLights lights = oneMap(*environment_map);
    const PartedLights parted = partLights(lights);
    EXPECT_LE(parted.keys.size(), 16u);
    EXPECT_LT(parted.loss_after, 0.25 * parted.loss_before);
    expectSane(parted);
    expectEnergyConserved(lights, parted, 5e-3f);  // coloured windows side by side in one key
  }
}

}  // namespace lambent::lighting
