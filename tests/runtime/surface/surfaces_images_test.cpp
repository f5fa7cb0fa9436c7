// Tests in which colour space each image of a bundle is stored on the GPU, depending on how materials use it.
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "runtime/draws/surface_record.hpp"
#include "runtime/streaming/residency.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {

using SurfaceImages = testing::GpuTest;

TEST_F(SurfaceImages, ColoursAreSrgbNormalsLinearAndAnImageThatIsBothIsHeldTwice) {
  // Image 0 is a base colour, 1 is emissive, 2 is a normal map, and 3 is the base colour of one material and
  // the normal map of another. No material uses image 4.
  bundle::Description description;
  for (std::int32_t i = 0; i < 5; ++i) {
    description.images.push_back({.name = "image", .mime_type = "image/png", .view = 0});
    description.textures.push_back({.image = i, .sampler = {}});
  }
  gltf::Material first, second;
  first.base_color_texture.texture = 0;
  first.emissive_texture.texture = 1;
  first.normal_texture.texture = 2;
  second.base_color_texture.texture = 3;
  second.normal_texture.texture = 3;
  description.materials = {first, second};

  streaming::Residency residency;
  ASSERT_TRUE(residency.add(description, 0));
  for (std::uint32_t i = 0; i < 5; ++i)
    ASSERT_TRUE(
        residency.upload(0, streaming::ImageChunk{{i}, 4, 3, std::vector<std::uint8_t>(4 * 12, 188)}));

  const streaming::ResidentBundle& bundle = residency.bundles()[0];
  const bool color[] = {true, true, false, true, true}, normals[] = {false, false, true, true, false};
  for (std::size_t i = 0; i < 5; ++i) {
    SCOPED_TRACE(i);
    EXPECT_EQ(bool(bundle.images[i]), color[i]);
    EXPECT_EQ(bool(bundle.linear_images[i]), normals[i]);
    if (color[i]) {
      EXPECT_EQ(bundle.images[i].desc().format, GLenum{GL_SRGB8_ALPHA8});
    }
    if (normals[i]) {
      EXPECT_EQ(bundle.linear_images[i].desc().format, GLenum{GL_RGBA8});
    }
  }
  // The size is 4 x 3 texels of four bytes, and a third more for mip levels.
  EXPECT_EQ(residency.bytesResident(), 6u * 64u) << "five images, one of them twice";
}

// Tests what counts as out of view.

namespace {

scene::Box cubeAt(glm::vec3 center) {
  return {center - 0.5f, center + 0.5f};
}

TEST(OutOfView, IsWhatLiesBeyondAPlaneOfTheFrustum) {
  const glm::mat4 perspective = glm::perspective(glm::radians(90.0f), 1.0f, 0.1f, 100.0f);
  EXPECT_FALSE(outOfView(perspective, cubeAt({0, 0, -5})));
  EXPECT_FALSE(outOfView(perspective, cubeAt({5.4f, 0, -5}))) << "a part of it is in view";
  EXPECT_TRUE(outOfView(perspective, cubeAt({6.6f, 0, -5})));
  EXPECT_TRUE(outOfView(perspective, cubeAt({0, 0, 5}))) << "behind the eye";
  EXPECT_TRUE(outOfView(perspective, cubeAt({0, 0, -200})));
  EXPECT_FALSE(outOfView(perspective, {glm::vec3(-50), glm::vec3(50)})) << "the eye is in it";
}

TEST(OutOfView, HoldsForParallelRaysToo) {
  const glm::mat4 flat = glm::ortho(-1.0f, 1.0f, -1.0f, 1.0f, 1.0f, 20.0f);
  EXPECT_FALSE(outOfView(flat, cubeAt({1.4f, 0, -5})));
  EXPECT_TRUE(outOfView(flat, cubeAt({1.6f, 0, -5})));
  EXPECT_TRUE(outOfView(flat, cubeAt({0, 0, 0})));
}

}  // namespace

}  // namespace lambent::frame
