// Tests the spheres that show materials.
#include <gtest/gtest.h>

#include "editor/session/materials.hpp"

namespace lambent::editor {
namespace {

constexpr std::uint32_t kSize = 33;

// Returns the texel at these shares of the picture.
const std::uint8_t* at(const spec::Rgba8Image& image, float x, float y) {
  const auto column = static_cast<std::size_t>(x * kSize), row = static_cast<std::size_t>(y * kSize);
  return &image.texels[(row * kSize + column) * 4];
}

gltf::MaterialFactors matte(const glm::vec3& color) {
  gltf::MaterialFactors material;
  material.base_color = color;
  material.metallic = 0.0f;
  return material;
}

TEST(MaterialPreview, ShowsTheColorOnASphere) {
  const spec::Rgba8Image red = previewOf(matte({0.8f, 0.02f, 0.02f}), kSize);
  EXPECT_EQ(at(red, 0.01f, 0.01f)[3], 0) << "the corner is transparent";
  EXPECT_EQ(at(red, 0.5f, 0.5f)[3], 255);
  EXPECT_GT(at(red, 0.5f, 0.5f)[0], at(red, 0.5f, 0.5f)[1] + 60);
  EXPECT_GT(at(red, 0.3f, 0.3f)[0], at(red, 0.7f, 0.8f)[0] + 20) << "the lamp stands above to the left";
}

TEST(MaterialPreview, TellsPolishedFromRoughAndDarkFromBright) {
  gltf::MaterialFactors polished = matte({0.05f, 0.05f, 0.05f});
  polished.roughness = 0.15f;
  int brightest = 0, rough = 0;
  const spec::Rgba8Image a = previewOf(polished, kSize), b = previewOf(matte({0.05f, 0.05f, 0.05f}), kSize);
  for (std::size_t i = 0; i < a.texels.size(); i += 4) {
    brightest = std::max(brightest, int{a.texels[i]});
    rough = std::max(rough, int{b.texels[i]});
  }
  EXPECT_GT(brightest, rough + 60) << "a highlight";
  gltf::MaterialFactors glowing = matte({0.0f, 0.0f, 0.0f});
  glowing.emission = {0.0f, 1.0f, 0.0f};
  EXPECT_EQ(at(previewOf(glowing, kSize), 0.5f, 0.5f)[1], 255);
}

}  // namespace
}  // namespace lambent::editor
