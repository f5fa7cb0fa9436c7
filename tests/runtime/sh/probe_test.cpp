// Tests measured light probes, which the project does not ship: two images of one place in different layouts,
// and figures printed in a paper.
#include <array>
#include <memory>
#include <vector>

#include <gtest/gtest.h>

#define STB_IMAGE_IMPLEMENTATION
#define STBI_ONLY_HDR
#include <stb_image.h>

#include "runtime/sh/image_layout.hpp"
#include "tests/support/shared_data.hpp"

namespace lambent::sh {
namespace {

LightVector projectFile(int order, const std::filesystem::path& path) {
  int width = 0, height = 0, channels = 0;
  const std::unique_ptr<float, void (*)(void*)> pixels(
      stbi_loadf(path.c_str(), &width, &height, &channels, 3), stbi_image_free);
  EXPECT_TRUE(pixels) << path;
  if (!pixels) return {};
  std::vector<glm::vec3> texels;
  for (int k = 0; k < width * height; ++k)
    texels.emplace_back(pixels.get()[3 * k], pixels.get()[3 * k + 1], pixels.get()[3 * k + 2]);
  return projectImage(order, layoutOfShape(width, height).value(), width, height, texels);
}

TEST(ShProbes, AngularMapAndCrossOfOnePlaceAgree) {
  const auto map = lambent::testing::sharedFile("probes/rnl_probe.hdr"),
             cross = lambent::testing::sharedFile("probes/rnl_cross.hdr");
  LAMBENT_NEEDS_SHARED(map);
  LAMBENT_NEEDS_SHARED(cross);
  const LightVector a = projectFile(3, map), b = projectFile(3, cross);
  for (std::size_t i = 0; i < 9; ++i)
    for (int channel = 0; channel < 3; ++channel) EXPECT_NEAR(a.c[i][channel], b.c[i][channel], 1e-3f) << i;
}

// Ramamoorthi and Hanrahan 2001: (R, G, B) of the first nine coefficients of Grace Cathedral, in our index
// order. Their map is turned round (z reversed) and scaled by 1/3.2.
TEST(ShProbes, GraceCathedralHasItsPrintedCoefficients) {
  const auto path = lambent::testing::sharedFile("probes/grace_probe.hdr");
  LAMBENT_NEEDS_SHARED(path);
  const std::array<glm::vec3, 9> printed = {{{.79f, .44f, .54f},
                                             {.39f, .35f, .60f},
                                             {-.34f, -.18f, -.27f},
                                             {-.29f, -.06f, .01f},
                                             {-.11f, -.05f, -.12f},
                                             {-.26f, -.22f, -.47f},
                                             {-.16f, -.09f, -.15f},
                                             {.56f, .21f, .14f},
                                             {.21f, -.05f, -.30f}}};
  const LightVector light = projectFile(3, path);
  for (std::size_t i = 0; i < 9; ++i) {
    const bool odd_in_z = i == 2 || i == 5 || i == 7;
    for (int channel = 0; channel < 3; ++channel)
      // The figures are printed to two decimals, so they are exact to 0.005.
      EXPECT_NEAR(light.c[i][channel] / 3.2f * (odd_in_z ? -1.0f : 1.0f), printed[i][channel], 0.0075f) << i;
  }
}

}  // namespace
}  // namespace lambent::sh
