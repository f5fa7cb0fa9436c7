// Checks that the environment maps are finite, have mean 1, and have the sun and the boxes where the source
// puts them.
#include <numbers>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "assets/environment_maps.hpp"
#include "runtime/spec/distant_lights.hpp"
#include "runtime/spec/light.hpp"

namespace lambent::assets {
namespace {

double luminance(glm::dvec3 c) {
  return glm::dot(c, glm::dvec3(0.2126, 0.7152, 0.0722));
}

double luminanceTowards(const spec::RgbImage& image, float azimuth_deg, float elevation_deg) {
  const spec::EnvironmentMap environment_map{image, sh::ImageLayout::LatLong};
  return luminance(
      spec::radiance(environment_map, spec::directionFromAzimuthElevation(azimuth_deg, elevation_deg)));
}

TEST(AssetsEnvironmentMaps, AreFinitePositiveAndOfMeanLuminanceOne) {
  for (const spec::RgbImage& image : {skyMap(256), studioMap(256)}) {
    for (const glm::vec3 texel : image.texels)
      for (int c = 0; c < 3; ++c) ASSERT_TRUE(std::isfinite(texel[c]) && texel[c] >= 0.0f);
    EXPECT_NEAR(luminance(integrate(image)) / (4 * std::numbers::pi), 1.0, 1e-5);
  }
}

TEST(AssetsEnvironmentMaps, TheSkyIsBlueAboveAndItsSunKeepsItsEnergyAtEveryWidth) {
  const spec::RgbImage large = skyMap(512), small = skyMap(128);
  // The sun is by far the brightest, so the light within six degrees of it is nearly all its own.
  const auto sunlight = [](const spec::RgbImage& image) {
    const glm::dvec3 to_sun(spec::directionFromAzimuthElevation(34.0f, 44.0f));
    spec::RgbImage near = image;
    for (std::uint32_t y = 0; y < image.height; ++y)
      for (std::uint32_t x = 0; x < image.width; ++x) {
        const glm::dvec3 dir =
            sh::texelDirection(sh::ImageLayout::LatLong, static_cast<int>(image.width),
                               static_cast<int>(image.height), static_cast<int>(x), static_cast<int>(y));
        if (glm::dot(dir, to_sun) < std::cos(6.0 * std::numbers::pi / 180))
          near.texels[y * image.width + x] *= 0.0f;
      }
    return luminance(integrate(near));
  };
  EXPECT_NEAR(sunlight(large) / sunlight(small), 1.0, 0.01);
  EXPECT_GT(luminanceTowards(large, 34, 44), 50.0);
  const spec::EnvironmentMap environment_map{large, sh::ImageLayout::LatLong};
  const glm::vec3 zenith = spec::radiance(environment_map, glm::vec3(0, 1, 0));
  EXPECT_GT(zenith.b, 1.5f * zenith.r);
  EXPECT_LT(luminanceTowards(large, 0, -60), 1.0);  // the ground reflects a quarter
}

}  // namespace
}  // namespace lambent::assets
