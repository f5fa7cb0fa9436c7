// Tests surfaces with large textures in memory that cannot hold all their levels.
#include <cmath>
#include <random>
#include <thread>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/streaming/textures.hpp"
#include "tests/support/frame/world_stage.hpp"

namespace lambent::frame {

using testing::WorldStage;
using testing::worst;

namespace {

constexpr std::uint32_t kTexels = 512;
constexpr std::uint64_t kNoLimit = ~std::uint64_t{0};

// Makes broad waves with fine grain.
std::vector<std::uint8_t> waves(std::uint32_t seed) {
  std::mt19937 engine(seed);
  std::vector<std::uint8_t> rgba;
  for (std::uint32_t y = 0; y < kTexels; ++y)
    for (std::uint32_t x = 0; x < kTexels; ++x) {
      const float wave = std::sin(0.03f * static_cast<float>(x)) * std::cos(0.02f * static_cast<float>(y));
      for (std::uint32_t c = 0; c < 3; ++c)
        rgba.push_back(static_cast<std::uint8_t>(130.0f + 60.0f * wave +
                                                 static_cast<float>(engine() % 30) * (c == 0 ? 1.0f : 0.5f)));
      rgba.push_back(255);
    }
  return rgba;
}

double relativeRms(const spec::RgbaImage& found, const spec::RgbaImage& expected) {
  double error = 0.0, energy = 0.0;
  for (std::size_t i = 0; i < found.texels.size(); ++i) {
    const glm::dvec3 a(found.texels[i]), b(expected.texels[i]);
    error += glm::dot(a - b, a - b);
    energy += glm::dot(b, b);
  }
  return std::sqrt(error / energy);
}

}  // namespace

struct TextureStreaming : testing::WorldTest {
  std::filesystem::path sheet(std::uint32_t i) {
    const std::filesystem::path path = file(fmt::format("sheet-{}.lmb.glb", i));
    if (std::filesystem::exists(path)) return path;
    testing::BundleBuilder builder;
    gltf::Material material;
    material.base_color_texture.texture = builder.addTexture(kTexels, kTexels, waves(i), {});
    builder
        .add({testing::quadMesh(), material,
              glm::translate(glm::mat4(1.0f), glm::vec3(2.2f * static_cast<float>(i), 0, 0))})
        .write(path);
    return path;
  }
  static spec::View view(float x) {
    const glm::vec3 eye(x, 0.0f, 3.0f);
    return {.view_from_world = glm::lookAt(eye, glm::vec3(x, 0, 0), glm::vec3(0, 1, 0)),
            .clip_from_view = glm::perspective(0.9f, 1.0f, 0.1f, 100.0f),
            .eye_ws = eye};
  }
  // Loads everything that fits for a camera at x, and renders it.
  spec::RgbaImage look(WorldStage& stage, float x) {
    stage.world.look(view(x));
    gpu::Counters counters;
    EXPECT_TRUE(stage.world.uploadAll(counters));
    stage.renderFrom(view(x));
    EXPECT_TRUE(stage.frame->rest(stage.world, stage.environment));
    stage.renderFrom(view(x));
    return stage.frame->readLinear();
  }
  static std::uint32_t finest(const WorldStage& stage, std::size_t bundle) {
    return stage.world.residency().bundles()[bundle].images[0].desc().width;
  }
};

TEST_F(TextureStreaming, BytesFallWithTheBudgetAndThePictureStaysNear) {
  constexpr std::uint32_t kSheets = 3;
  WorldStage whole(lights);
  for (std::uint32_t i = 0; i < kSheets; ++i) whole.open(sheet(i));
  const spec::RgbaImage expected = look(whole, 0.0f);
  const std::uint64_t all_bytes = whole.world.residency().bytesResident();
  const std::uint64_t texture_bytes = streaming::textureBytes({kTexels, kTexels});
  ASSERT_GT(all_bytes, kSheets * texture_bytes);
  ASSERT_LT(all_bytes, kSheets * texture_bytes + 100'000) << "all else is little";

  WorldStage ample(lights, {.max_resident_bytes = std::uint64_t{1} << 30});
  for (std::uint32_t i = 0; i < kSheets; ++i) ample.open(sheet(i));
  EXPECT_EQ(worst(look(ample, 0.0f), expected), 0.0) << "with room for all, the same picture";
  EXPECT_EQ(ample.world.residency().bytesResident(), all_bytes);

  double before = 0.0;
  for (const std::uint64_t share : {2u, 4u, 10u}) {
    const std::uint64_t budget = all_bytes / share;
    WorldStage stage(lights, {.max_resident_bytes = budget});
    for (std::uint32_t i = 0; i < kSheets; ++i) stage.open(sheet(i));
    const spec::RgbaImage image = look(stage, 0.0f);
    EXPECT_LE(stage.world.residency().bytesResident(), budget);
    EXPECT_GE(finest(stage, 0), finest(stage, 2)) << "what is near has the finer one";
    EXPECT_GE(finest(stage, 2), streaming::kCoarseSide);
    const double error = relativeRms(image, expected);
    EXPECT_LT(error, 0.03) << "a share of one in " << share;
    EXPECT_GE(error, before);
    before = error;
  }
  EXPECT_GT(before, 0.0);
}

TEST_F(TextureStreaming, TheFinestLevelsGoWhereTheCameraLeavesAndComeBack) {
  WorldStage stage(lights, {.max_resident_bytes = streaming::textureBytes({kTexels, kTexels}) * 3 / 2});
  for (std::uint32_t i = 0; i < 6; ++i) stage.open(sheet(i));
  const spec::RgbaImage first = look(stage, 0.0f);
  EXPECT_EQ(finest(stage, 0), kTexels);
  EXPECT_LT(finest(stage, 5), kTexels);
  look(stage, 11.0f);
  EXPECT_LT(finest(stage, 0), kTexels);
  EXPECT_EQ(finest(stage, 5), kTexels);
  EXPECT_EQ(worst(look(stage, 0.0f), first), 0.0);
}

TEST_F(TextureStreaming, ALargeTextureComesOverSeveralFramesAndIsSeenWhenItIsWhole) {
  constexpr std::uint64_t kPerFrame = std::uint64_t{128} << 10;
  for (const std::uint64_t limit : {kNoLimit, std::uint64_t{1} << 30}) {
    WorldStage stage(lights, {.max_resident_bytes = limit});
    stage.uploadAtMost(kPerFrame);
    stage.open(sheet(0));
    int frames = 0;
    for (; frames < 2000 && !(frames > 2 && stage.world.loaded()); ++frames) {
      gpu::Counters counters;
      stage.world.look(view(0.0f));
      ASSERT_TRUE(stage.world.upload(kPerFrame, counters));
      ASSERT_LE(counters.uploaded_bytes, kPerFrame + 4 * kTexels) << "a row more at most";
      if (stage.world.residency().present(0))
        if (const gpu::Texture& shown = stage.world.residency().bundles()[0].images[0]; shown) {
          ASSERT_TRUE(limit != kNoLimit || shown.desc().width == kTexels);
        }
      std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    EXPECT_GE(frames, static_cast<int>(4 * kTexels * kTexels / kPerFrame));
    WorldStage expected(lights);
    expected.open(sheet(0));
    EXPECT_EQ(worst(look(stage, 0.0f), look(expected, 0.0f)), 0.0);
  }
}

}  // namespace lambent::frame
