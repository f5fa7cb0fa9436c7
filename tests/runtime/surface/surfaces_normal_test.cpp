// Tests normal maps on the CPU: light received at a normal, and the tangent frame; in which colour space each
// image of a bundle is stored on the GPU; and what a camera sees of boxes.
#include <algorithm>
#include <random>

#include <glm/gtc/matrix_transform.hpp>
#include <glm/gtc/quaternion.hpp>
#include <glm/mat3x3.hpp>
#include <gtest/gtest.h>

#include "runtime/draws/surface_record.hpp"
#include "runtime/sh/zonal.hpp"
#include "runtime/streaming/residency.hpp"
#include "tests/runtime/surface/surface_normal.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

struct SurfaceNormal : ::testing::Test, glsl::SurfaceNormal {};

struct Random {
  std::mt19937 engine{7};
  float number() { return std::uniform_real_distribution<float>(-1.0f, 1.0f)(engine); }
  glm::vec3 vector() { return {number(), number(), number()}; }
  glm::vec3 direction() {
    glm::vec3 v = vector();
    while (glm::dot(v, v) > 1.0f || glm::dot(v, v) < 0.01f) v = vector();
    return glm::normalize(v);
  }
};

// Describes a patch of a plane as a camera sees it: how position and texture coordinates change over the
// picture.
struct Patch {
  glm::vec3 normal, rising_u, rising_v;  // rising_u, rising_v: dp/du, dp/dv
  glm::vec2 t_dx{0.3f, -0.1f}, t_dy{0.05f, 0.2f};

  glsl::SurfaceNormal::TangentFrame frame() const {
    const auto moved = [&](glm::vec2 t) { return t.x * rising_u + t.y * rising_v; };
    return glsl::SurfaceNormal().frameFromDerivatives(normal, moved(t_dx), moved(t_dy), t_dx, t_dy);
  }
};

TEST_F(SurfaceNormal, ReceivesThreeBandsAsOpenTransferDoes) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    std::array<glm::vec3, 9> light{};
    for (glm::vec3& coefficient : light) coefficient = random.vector();
    const glm::vec3 normal = random.direction();
    std::array<float, 9> transfer{};
    sh::unoccludedTransfer(3, normal, transfer);
    glm::vec3 expected(0.0f);
    for (std::size_t j = 0; j < 9; ++j) expected += transfer[j] * light[j];
    EXPECT_LT(glm::distance(diffuseLight(light.data(), normal), expected), 1e-6f);  // rounding of 9 terms
  }
}

TEST_F(SurfaceNormal, FindsTheFrameFromThePictureAlsoUnderMirroredCoordinates) {
  Random random;
  for (int i = 0; i < 50; ++i) {
    const glm::quat turn = glm::angleAxis(3.0f * random.number(), random.direction());
    const glm::vec3 x = turn * glm::vec3(1, 0, 0), y = turn * glm::vec3(0, 1, 0),
                    z = turn * glm::vec3(0, 0, 1);
    // u to the right and v downwards is a picture that is seen upright.
    for (const float mirrored : {1.0f, -1.0f}) {
      const TangentFrame frame =
          Patch{.normal = z, .rising_u = mirrored * 2.0f * x, .rising_v = -0.5f * y}.frame();
      EXPECT_LT(glm::distance(frame.tangent, mirrored * x), 1e-5f);
      EXPECT_EQ(frame.handedness, mirrored);
      const glm::vec3 up = perturbedNormal(frame, {0.5f, 1.0f, 0.5f}, 1.0f);
      EXPECT_LT(glm::distance(up, y), 1e-5f) << "green points to the top of the picture";
      const glm::vec3 right = perturbedNormal(frame, {1.0f, 0.5f, 0.5f}, 1.0f);
      EXPECT_LT(glm::distance(right, mirrored * x), 1e-5f);
    }
  }
}

TEST_F(SurfaceNormal, StaysWhereThereIsNoFrameAndWhereTheMapIsFlat) {
  const glm::vec3 z(0, 0, 1), texel(0.9f, 0.2f, 0.7f);
  // All texture coordinates are equal, or they change only along a line.
  const Patch patches[] = {
      {.normal = z, .rising_u = {1, 0, 0}, .rising_v = {0, 1, 0}, .t_dx = {0, 0}, .t_dy = {0, 0}},
      {.normal = z, .rising_u = {1, 0, 0}, .rising_v = {0, 1, 0}, .t_dx = {1, 0}, .t_dy = {2, 0}}};
  for (const Patch& patch : patches) EXPECT_EQ(perturbedNormal(patch.frame(), texel, 1.0f), z);
  EXPECT_EQ(perturbedNormal(frameFromTangent(z, glm::vec4(0.0f)), texel, 1.0f), z);
  EXPECT_EQ(perturbedNormal(frameFromTangent(z, {1, 0, 0, 1}), {0.5f, 0.5f, 1.0f}, 1.0f), z);
  EXPECT_EQ(perturbedNormal(frameFromTangent(z, {1, 0, 0, 1}), texel, 0.0f), z);
}

TEST_F(SurfaceNormal, TheScaleBendsXAndYOnly) {
  const TangentFrame frame = frameFromTangent({0, 0, 1}, {1, 0, 0, -1});
  // The value is (0.5, 0.5, 0.5) scaled by 2 on x and y, with y multiplied by the handedness.
  const glm::vec3 bent = perturbedNormal(frame, glm::vec3(0.75f), 2.0f);
  EXPECT_LT(glm::distance(bent, glm::normalize(glm::vec3(2, -2, 1))), 1e-6f);
}

}  // namespace
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
