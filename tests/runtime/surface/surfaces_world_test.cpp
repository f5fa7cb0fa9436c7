// Tests how a bundle's materials appear in the picture: emission, unlit surfaces, textures, and their
// batching.
#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/frame/frame.hpp"
#include "runtime/scene/bounds.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::frame {
namespace {

using testing::BundleBuilder;
using testing::quadMesh;

constexpr gltf::Sampler kNearest{
    .wrap_s = GL_REPEAT, .wrap_t = GL_REPEAT, .mag_filter = GL_NEAREST, .min_filter = GL_NEAREST};

}  // namespace

class SurfacesWorld : public testing::GpuTest {
 protected:
  // Renders a linear picture of 32 x 32 in uniform light, seen from +Z, or from behind.
  spec::RgbaImage show(const BundleBuilder& builder, float radiance, bool from_behind = false) {
    const std::filesystem::path path =
        std::filesystem::path(::testing::TempDir()) / fmt::format("{}-surfaces.lmb.glb", getpid());
    builder.write(path);
    World world;
    const Result<std::uint32_t> opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    gpu::Counters loading;
    EXPECT_TRUE(world.uploadAll(loading));
    std::filesystem::remove(path);
    const spec::Light light = spec::ConstantLight{.radiance = glm::vec3(radiance)};
    auto environment = lighting::Environment::create(std::vector<spec::Light>{light});
    FrameOptions options;
    options.output = Output::Linear;
    options.size = {32, 32};
    Result<Frame> frame = Frame::create(options, *environment);
    EXPECT_TRUE(frame) << frame.error().line();
    if (!opened || !frame) return {};
    world.updateTransforms();
    const scene::Box bounds = scene::worldBounds(world.registry());
    const spec::OrbitCamera camera{.azimuth_deg = from_behind ? 180.0f : 0.0f,
                                   .elevation_deg = 0.0f,
                                   .distance_radii = 2.5f,
                                   .fov_deg = 40.0f};
    EXPECT_TRUE(frame->render(world, *environment, spec::orbitView(camera, bounds.min, bounds.max, 1.0f)));
    frame->timers().finish();
    for (const gpu::PassTime& pass : frame->timers().latest())
      if (pass.name == "raster") raster = pass.counters;
    return frame->readLinear();
  }

  static glm::vec3 at(const spec::RgbaImage& image, std::uint32_t x, std::uint32_t y) {
    return glm::vec3(image.texels[y * image.width + x]);
  }

  gpu::Counters raster;  // of the last picture
};

TEST_F(SurfacesWorld, EmissionIsAddedOnBothSidesOfACard) {
  gltf::Material material;
  material.base_color = {0.5f, 0.25f, 0.0f, 1.0f};
  material.emissive = {8.0f, 1.0f, 0.5f};
  material.double_sided = true;
  for (const bool from_behind : {false, true}) {
    const spec::RgbaImage image = show(BundleBuilder().add({quadMesh(), material}), 1.0f, from_behind);
    ASSERT_FALSE(image.texels.empty());
    // The basis is stored in half floats: 2^-11 relative.
    EXPECT_LT(glm::distance(at(image, 16, 16), glm::vec3(8.5f, 1.25f, 0.5f)), 1e-3f);
  }
}

TEST_F(SurfacesWorld, EachTextureHasItsOwnCoordinatesAndTransform) {
  // The base colour is red, then green, from the left, by TEXCOORD_0. The emission is black, then 188 =
  // 0.5029, from the left, by TEXCOORD_1, which runs the other way and is mirrored by scale -1.
  BundleBuilder builder;
  gltf::Material material;
  material.base_color_texture.texture = builder.addTexture(2, 1, {255, 0, 0, 255, 0, 255, 0, 255}, kNearest);
  material.emissive = glm::vec3(2.0f);
  material.emissive_texture = {
      .texture = builder.addTexture(2, 1, {0, 0, 0, 255, 188, 188, 188, 255}, kNearest), .texcoord = 1};
  bundle::MeshData mesh = quadMesh();
  for (const glm::vec2& place : mesh.texcoords0) mesh.texcoords1.emplace_back(1.0f - place.x, place.y);
  const glm::vec3 red(1, 0, 0), green(0, 1, 0), glow(2.0f * 0.5029f);
  {
    const spec::RgbaImage image = show(BundleBuilder(builder).add({mesh, material}), 1.0f);
    ASSERT_FALSE(image.texels.empty());
    EXPECT_LT(glm::distance(at(image, 12, 16), red + glow), 4e-3f);  // eight bits and half floats
    EXPECT_LT(glm::distance(at(image, 19, 16), green), 2e-3f);
  }
  material.emissive_texture.scale = {-1.0f, 1.0f};
  material.emissive_texture.offset = {1.0f, 0.0f};
  const spec::RgbaImage image = show(BundleBuilder(builder).add({mesh, material}), 1.0f);
  ASSERT_FALSE(image.texels.empty());
  EXPECT_LT(glm::distance(at(image, 12, 16), red), 2e-3f);
  EXPECT_LT(glm::distance(at(image, 19, 16), green + glow), 4e-3f);
}

TEST_F(SurfacesWorld, UnlitSurfacesShowTheirBaseColourAndGiveOffNothingElse) {
  gltf::Material material;
  material.base_color = {0.5f, 0.25f, 0.125f, 1.0f};
  material.emissive = glm::vec3(1.0f);
  material.unlit = true;
  for (const float radiance : {0.0f, 5.0f}) {
    const spec::RgbaImage image = show(BundleBuilder().add({quadMesh(), material}), radiance);
    ASSERT_FALSE(image.texels.empty());
    EXPECT_LT(glm::distance(at(image, 16, 16), glm::vec3(0.5f, 0.25f, 0.125f)), 1e-6f);
  }
}

TEST_F(SurfacesWorld, DrawsOfTheSameTexturesAreOneCallAndUnreadTexturesPartNothing) {
  BundleBuilder builder;
  const std::int32_t first = builder.addTexture(1, 1, {255, 255, 255, 255}, kNearest);
  const std::int32_t second = builder.addTexture(1, 1, {255, 255, 255, 255}, kNearest);
  const auto calls = [&](const std::vector<glm::vec3>& emissions) {
    BundleBuilder several = builder;
    for (std::size_t i = 0; i < emissions.size(); ++i) {
      gltf::Material material;
      material.base_color_texture.texture = first;
      material.emissive_texture.texture = i % 2 == 0 ? first : second;
      material.emissive = emissions[i];
      several.add({quadMesh(), material,
                   glm::translate(glm::mat4(1.0f), glm::vec3(static_cast<float>(i), 0.0f, 0.0f))});
    }
    show(several, 1.0f);
    EXPECT_EQ(raster.draws, emissions.size() + 1) << "and the sky";
    return raster.draw_calls - 1;
  };
  const glm::vec3 none(0.0f), some(1.0f);
  EXPECT_EQ(calls({none, none, none, none}), 1u);
  EXPECT_EQ(calls({some, some, some, some}), 2u);
  EXPECT_EQ(calls({some, none, some, none}), 2u);
}

}  // namespace lambent::frame
