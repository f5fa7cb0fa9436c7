#include "runtime/sh/projection.hpp"

#include <limits>
#include <numbers>
#include <vector>

#include <gtest/gtest.h>

#include "runtime/sh/zonal.hpp"

namespace lambent::sh {
namespace {

struct PictureShape {
  ImageLayout layout;
  int width, height;
  double tolerance;  // of a constant picture's other coefficients: the layout's quadrature, O(1/width²)
};
constexpr PictureShape kPictureShapes[] = {{ImageLayout::LatLong, 512, 256, 2e-4},
                                           {ImageLayout::AngularMap, 400, 400, 2e-4},
                                           {ImageLayout::VerticalCross, 384, 512, 2e-4}};

std::vector<glm::vec3> picture(const PictureShape& shape, const LightVector& light) {
  std::vector<glm::vec3> texels;
  for (int y = 0; y < shape.height; ++y)
    for (int x = 0; x < shape.width; ++x)
      texels.push_back(
          light.evaluate(glm::vec3(texelDirection(shape.layout, shape.width, shape.height, x, y))));
  return texels;
}

TEST(ShProjection, MakesAConstantPictureConstantLight) {
  for (const PictureShape& shape : kPictureShapes) {
    const std::vector<glm::vec3> texels(static_cast<std::size_t>(shape.width * shape.height),
                                        glm::vec3(1, 2, 0.5f));
    ProjectionReport report;
    const LightVector light = projectImage(6, shape.layout, shape.width, shape.height, texels, &report);
    const LightVector expected = constantLight(6, {1, 2, 0.5f});
    for (std::size_t i = 0; i < 36; ++i)
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(light.c[i][channel], expected.c[i][channel], 2 * shape.tolerance)
            << name(shape.layout) << ", coefficient " << i;
    EXPECT_NEAR(report.solid_angle_sr, 4 * std::numbers::pi, shape.tolerance);
    EXPECT_EQ(report.replaced_texels, 0u);
  }
}

TEST(ShProjection, GivesBackABandLimitedLight) {
  const LightVector light = discLight(6, {0.6f, 0.48f, 0.64f}, 0.5, {3, 1, 2}) + constantLight(6, {1, 1, 1});
  for (const PictureShape& shape : kPictureShapes) {
    const LightVector back = projectImage(6, shape.layout, shape.width, shape.height, picture(shape, light));
    for (std::size_t i = 0; i < 36; ++i)
      for (int channel = 0; channel < 3; ++channel)
        EXPECT_NEAR(back.c[i][channel], light.c[i][channel], 5 * shape.tolerance)
            << name(shape.layout) << " " << i;
  }
}

TEST(ShProjection, CountsAndReplacesWhatIsNotLight) {
  std::vector<glm::vec3> texels(64 * 32, glm::vec3(1));
  std::vector<glm::vec3> mended = texels;
  const float infinity = std::numeric_limits<float>::infinity();
  texels[5].g = std::numeric_limits<float>::quiet_NaN();
  texels[700].r = infinity;
  texels[701].b = -infinity;
  for (int k : {5, 700, 701}) mended[static_cast<std::size_t>(k)] = glm::vec3(0);
  texels[900].r = mended[900].r = -1;
  texels[1000] = mended[1000] = glm::vec3(1e30f);

  ProjectionReport report;
  const LightVector light = projectImage(5, ImageLayout::LatLong, 64, 32, texels, &report);
  const LightVector expected = projectImage(5, ImageLayout::LatLong, 64, 32, mended);
  EXPECT_EQ(report.covered_texels, 64u * 32);
  EXPECT_EQ(report.replaced_texels, 3u);
  EXPECT_EQ(report.negative_texels, 1u);
  for (std::size_t i = 0; i < 25; ++i) EXPECT_EQ(light.c[i], expected.c[i]);
}

}  // namespace
}  // namespace lambent::sh
