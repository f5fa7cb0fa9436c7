// Tests that looking up a direction gives the same environment for every image layout, without seams.
#include <filesystem>
#include <limits>
#include <random>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/spec/distant_lights.hpp"

namespace lambent::spec {
namespace {

using sh::ImageLayout;

struct Shape {
  ImageLayout layout;
  std::uint32_t width, height;
};
constexpr Shape kShapes[] = {{ImageLayout::LatLong, 128, 64},
                             {ImageLayout::AngularMap, 128, 128},
                             {ImageLayout::VerticalCross, 96, 128}};

// Makes an image of f; texels outside the layout hold a value that no look-up may return.
template <typename Function>
EnvironmentMap picture(const Shape& shape, const Function& f) {
  constexpr float kPoison = 1e6f;
  EnvironmentMap environment_map{{shape.width, shape.height, {}}, shape.layout};
  for (int y = 0; y < static_cast<int>(shape.height); ++y)
    for (int x = 0; x < static_cast<int>(shape.width); ++x) {
      const glm::dvec3 dir = sh::texelDirection(shape.layout, static_cast<int>(shape.width),
                                                static_cast<int>(shape.height), x, y);
      environment_map.image.texels.push_back(dir == glm::dvec3(0.0) ? glm::vec3(kPoison) : f(glm::vec3(dir)));
    }
  return environment_map;
}

std::vector<glm::vec3> directions(int count) {
  std::vector<glm::vec3> dirs;
  // Axes, edges and corners of the cube: poles, seams and the back of every layout.
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z)
        if (x || y || z) dirs.push_back(glm::normalize(glm::vec3(x, y, z)));
  std::mt19937 random(1);
  std::normal_distribution<float> normal;
  while (static_cast<int>(dirs.size()) < count)
    dirs.push_back(glm::normalize(glm::vec3(normal(random), normal(random), normal(random))));
  return dirs;
}

TEST(SpecEnvironmentMap, ASmoothEnvironmentComesBackFromEveryLayout) {
  const auto f = [](glm::vec3 d) { return glm::vec3(2.0f + d.x, 2.0f + d.y * d.z, 2.0f + d.z); };
  for (const Shape& shape : kShapes) {
    const EnvironmentMap environment_map = picture(shape, f);
    for (const glm::vec3 dir : directions(4000)) {
      // Texels are about 2.8 degrees wide; at the back of the angular map they are pulled by up to one more.
      const float tolerance = shape.layout == ImageLayout::AngularMap && dir.z > 0.99f ? 0.06f : 0.008f;
      EXPECT_LT(glm::length(radiance(environment_map, dir) - f(dir)), tolerance)
          << sh::name(shape.layout) << " " << dir.x << " " << dir.y << " " << dir.z;
    }
  }
}

TEST(SpecEnvironmentMap, HasNoSeams) {
  // Grey noise: an error in choosing a neighbour is as large as the noise itself.
  for (const Shape& shape : kShapes) {
    std::mt19937 random(2);
    const EnvironmentMap environment_map =
        picture(shape, [&](glm::vec3) { return glm::vec3(static_cast<float>(random() % 1000) / 1000.0f); });
    for (const glm::vec3 dir : directions(2000)) {
      if (shape.layout == ImageLayout::AngularMap && dir.z > 0.99f) continue;  // its rim is one direction
      if (shape.layout == ImageLayout::LatLong && std::abs(dir.y) > 0.99f) continue;  // so are its poles
      const glm::vec3 beside = glm::normalize(dir + 2e-6f * glm::vec3(dir.y, dir.z, -dir.x));
      // The largest change is 1 over a texel of 0.02 rad (cross, corners). At a corner of the cube four
      // texels are only three, which leaves a step of up to a quarter.
      const glm::vec3 size = glm::abs(dir);
      const bool corner =
          shape.layout == ImageLayout::VerticalCross && std::min({size.x, size.y, size.z}) > 0.55f;
      EXPECT_LT(std::abs(radiance(environment_map, dir).x - radiance(environment_map, beside).x),
                corner ? 0.3f : 2e-3f)
          << sh::name(shape.layout) << " " << dir.x << " " << dir.y << " " << dir.z;
    }
  }
}

TEST(SpecEnvironmentMap, TexelCentresGiveTheTexelItself) {
  for (const Shape& shape : kShapes) {
    float next = 0.0f;
    const EnvironmentMap environment_map = picture(shape, [&](glm::vec3) { return glm::vec3(next += 1.0f); });
    for (int y = 0; y < static_cast<int>(shape.height); y += 3)
      for (int x = 0; x < static_cast<int>(shape.width); ++x) {
        const glm::dvec3 dir = sh::texelDirection(shape.layout, static_cast<int>(shape.width),
                                                  static_cast<int>(shape.height), x, y);
        if (dir == glm::dvec3(0.0)) continue;
        const float texel =
            environment_map.image
                .texels[static_cast<std::size_t>(y) * shape.width + static_cast<std::size_t>(x)]
                .x;
        // A float direction lies up to 1e-6 rad off; texels differ by up to a row (128) or more over a seam.
        EXPECT_NEAR(radiance(environment_map, glm::vec3(dir)).x, texel, 0.5f)
            << sh::name(shape.layout) << " " << x << " " << y;
      }
  }
}

TEST(SpecEnvironmentMap, ValuesThatAreNoRadiancesAreReplacedAndCounted) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "lambent_spec_not_finite.exr";
  RgbaImage image{4, 2, std::vector<glm::vec4>(8, glm::vec4(1.0f))};
  image.texels[1].x = std::numeric_limits<float>::quiet_NaN();
  image.texels[6].z = -std::numeric_limits<float>::infinity();
  image.texels[3].y = -0.25f;  // as filters leave it
  image.texels[5].x = 3e38f;
  image.texels[0].y = std::numeric_limits<float>::infinity();  // a sun that half floats cannot hold
  ASSERT_TRUE(writeExr(path, image));
  const Result<EnvironmentMap> environment_map = loadEnvironmentMap({path, {}});
  ASSERT_TRUE(environment_map) << environment_map.error().line();
  const std::vector<glm::vec3>& texels = environment_map->image.texels;
  EXPECT_EQ(texels[0], glm::vec3(1.0f, 65504.0f, 1.0f));
  EXPECT_EQ(texels[1], glm::vec3(0.0f, 1.0f, 1.0f));
  EXPECT_EQ(texels[2], glm::vec3(1.0f));
  EXPECT_EQ(texels[3], glm::vec3(1.0f, 0.0f, 1.0f));
  EXPECT_EQ(texels[5], glm::vec3(65504.0f, 1.0f, 1.0f));
  EXPECT_EQ(texels[6], glm::vec3(1.0f, 1.0f, 0.0f));
  ASSERT_EQ(environment_map->image.notices.size(), 2u);
  EXPECT_TRUE(environment_map->image.notices[0].starts_with("is negative or no number in 3 of 8 texels"));
  EXPECT_TRUE(environment_map->image.notices[1].starts_with("is infinite or above 1e15 in 2 of 8 texels"));
  std::filesystem::remove(path);
}

TEST(SpecEnvironmentMap, ShapesChooseTheLayoutAndWrongOnesAreExplained) {
  const auto path = std::filesystem::path(::testing::TempDir()) / "lambent_spec_shape.exr";
  ASSERT_TRUE(writeExr(path, {5, 3, std::vector<glm::vec4>(15, glm::vec4(1.0f))}));
  const Result<EnvironmentMap> unknown = loadEnvironmentMap({path, {}});
  ASSERT_FALSE(unknown);
  EXPECT_NE(unknown.error().line().find("--light-layout"), std::string::npos) << unknown.error().line();
  EXPECT_EQ(loadEnvironmentMap({path, ImageLayout::LatLong}).value().layout, ImageLayout::LatLong);
  EXPECT_FALSE(loadEnvironmentMap({path, ImageLayout::VerticalCross}));
  EXPECT_FALSE(loadEnvironmentMap({path, ImageLayout::AngularMap}));
  std::filesystem::remove(path);
}

}  // namespace
}  // namespace lambent::spec
