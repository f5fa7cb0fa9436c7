// Tests a row of bundles that need three times the available memory, with a camera that flies along it.
#include <cmath>
#include <random>
#include <thread>

#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "runtime/streaming/textures.hpp"
#include "runtime/world/frame_times.hpp"
#include "tests/support/eventually.hpp"
#include "tests/support/frame/world_stage.hpp"

namespace lambent::frame {

using testing::WorldStage;
using testing::worst;

namespace {

constexpr std::uint32_t kBundles = 12;
constexpr float kApart_m = 8.0f;

spec::View at(float x) {
  const glm::vec3 eye(x, 0.0f, 4.0f);
  return {.view_from_world = glm::lookAt(eye, eye - glm::vec3(0, 0, 1), glm::vec3(0, 1, 0)),
          .clip_from_view = glm::perspective(0.8f, 1.0f, 0.1f, 200.0f),
          .eye_ws = eye};
}

}  // namespace

struct WorldStreaming : testing::WorldTest {
  std::filesystem::path sphereFile(std::uint32_t i) {
    const std::filesystem::path path = file(fmt::format("sphere-{}.lmb.glb", i));
    if (std::filesystem::exists(path)) return path;
    gltf::Material material;
    material.base_color = {0.2f + 0.06f * static_cast<float>(i), 0.6f, 0.4f, 1.0f};
    testing::BundleBuilder(5)
        .add({testing::sphereMesh(48, 96), material,
              glm::translate(glm::mat4(1.0f), glm::vec3(kApart_m * static_cast<float>(i), 0, 0))})
        .write(path);
    return path;
  }
  void openAll(WorldStage& stage) {
    for (std::uint32_t i = 0; i < kBundles; ++i) stage.open(sphereFile(i));
  }
};

TEST_F(WorldStreaming, ResidencyFollowsTheCameraWithinTheBudget) {
  WorldStage whole(lights);
  openAll(whole);
  whole.picture();
  const std::uint64_t budget = whole.world.residency().bytesResident() / 3;

  WorldStage stage(lights, {.max_resident_bytes = budget});
  stage.uploadAtMost(std::uint64_t{1} << 20);
  openAll(stage);
  EXPECT_EQ(stage.world.residency().bytesResident(), 0u);
  const auto fly = [&](float x) {
    stage.renderFrom(at(x));
    ASSERT_LE(stage.world.residency().bytesResident(), budget) << "at " << x;
    ASSERT_TRUE(stage.world.errors().empty());
  };
  int frames = 0;
  const auto restAt = [&](float x) {
    return lambent::testing::eventually([&] {
      fly(x);
      return ++frames > 3 && stage.world.streaming().queued == 0;
    });
  };
  ASSERT_TRUE(restAt(0.0f));
  const auto first = stage.world.streaming();
  EXPECT_EQ(first.bundles[0].state, BundleStatus::State::Whole);
  EXPECT_LT(first.bundles[11].resident_bytes, first.bundles[11].whole_bytes);
  // The camera flies along the row and stops at the end.
  constexpr float kEnd = kApart_m * (kBundles - 1);
  for (int frame = 0; frame <= 200; ++frame) fly(kEnd * static_cast<float>(frame) / 200.0f);
  ASSERT_TRUE(restAt(kEnd));
  const auto last = stage.world.streaming();
  EXPECT_EQ(last.bundles[11].state, BundleStatus::State::Whole);
  EXPECT_LT(last.bundles[0].resident_bytes, last.bundles[0].whole_bytes) << "made room";
  // Near bundles look as if all of them fitted into memory.
  stage.renderFrom(at(kEnd));
  whole.renderFrom(at(kEnd));
  EXPECT_EQ(worst(stage.frame->readLinear(), whole.frame->readLinear()), 0.0);
  // Nothing is loaded or dropped while the camera stands still.
  const std::uint64_t version = stage.world.residency().version();
  for (int frame = 0; frame < 5; ++frame) fly(kEnd);
  EXPECT_EQ(stage.world.residency().version(), version);
}

TEST_F(WorldStreaming, WhatLostItsTransferIsLitWithoutShadowsAndGetsItBack) {
  WorldStage stage(lights, {.max_resident_bytes = 700'000});
  stage.uploadAtMost(std::uint64_t{1} << 24);
  stage.open(floorFile());
  stage.open(sphereFile(0));
  stage.open(sphereFile(1));
  gpu::Counters counters;
  std::vector<spec::RgbaImage> images;
  for (const float x : {0.0f, kApart_m, 0.0f}) {
    stage.world.look(at(x));
    ASSERT_TRUE(stage.world.uploadAll(counters));
    stage.renderFrom(at(x));
    ASSERT_TRUE(stage.frame->rest(stage.world, stage.environment));
    stage.renderFrom(at(x));
    images.push_back(stage.frame->readLinear());
  }
  EXPECT_EQ(worst(images[0], images[2]), 0.0);
}

TEST(FrameTimesTest, SaysHowManyFramesStandOut) {
  FrameTimes times(100);
  for (int i = 0; i < 250; ++i) times.add(i % 50 == 49 ? 25.0 : 10.0);
  EXPECT_EQ(times.count(), 100u);
  EXPECT_EQ(times.median(), 10.0);
  EXPECT_EQ(times.worst(), 25.0);
  EXPECT_EQ(times.last(), 25.0);
  EXPECT_EQ(times.overTwiceMedian(), 2u);
  EXPECT_EQ(times.histogram(8), (std::vector<std::size_t>{0, 0, 0, 0, 98, 0, 0, 2}));
}

TEST(FrameTimesTest, UploadsShrinkWhereFramesTakeLongerAndGrowAgain) {
  UploadPacer pacer;
  constexpr std::uint64_t kMost = 16 << 20;
  for (int i = 0; i < 100; ++i) pacer.frameTook(10.0, true, kMost);
  EXPECT_EQ(pacer.budget(kMost), kMost);
  pacer.frameTook(20.0, true, kMost);
  EXPECT_EQ(pacer.budget(kMost), kMost / 2);
  pacer.frameTook(40.0, false, kMost);
  EXPECT_EQ(pacer.budget(kMost), kMost / 2) << "that was something else";
  for (int i = 0; i < 100; ++i) pacer.frameTook(30.0, true, kMost);
  EXPECT_GT(pacer.budget(kMost), 0u) << "something always comes";
}

// A scene that has partly arrived takes far longer to draw than the empty world before it.
// Frames of seconds bring several batches each, for a share of their time; fast ones never wait.
TEST_F(WorldStreaming, OneSlowFrameBringsSeveralBatches) {
  WorldStage stage(lights);
  openAll(stage);
  stage.world.updateTransforms();
  gpu::Counters counters;
  ASSERT_TRUE(stage.world.upload(std::uint64_t{1} << 30, counters));
  EXPECT_FALSE(stage.world.loaded()) << "no more than a batch each comes without waiting";
  ASSERT_TRUE(stage.world.upload(std::uint64_t{1} << 30, counters, /*most_wait_s=*/60.0));
  EXPECT_TRUE(stage.world.loaded());
  EXPECT_TRUE(stage.world.errors().empty());
}

TEST(FrameTimesTest, SlowFramesDoNotStarveWhatLoads) {
  UploadPacer pacer;
  constexpr std::uint64_t kMost = 16 << 20;
  for (int i = 0; i < 100; ++i) pacer.frameTook(10.0, false, kMost);
  double bytes = 0.0, seconds = 0.0, frame_ms = 100.0;
  while (bytes < 32 << 20 && seconds < 60.0) {
    bytes += static_cast<double>(pacer.budget(kMost));
    seconds += 1e-3 * frame_ms;
    pacer.frameTook(frame_ms, true, kMost);
    frame_ms *= 1.3;  // each longer than those before
  }
  EXPECT_LT(seconds, 6.0) << "32 MiB";
}

// Tests surfaces with large textures in memory that cannot hold all their levels.

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
