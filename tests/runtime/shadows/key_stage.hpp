// Draws a small bundle under lights from infinity, for tests of key lights in whole pictures.
#pragma once

#include <cstdint>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/frame/frame.hpp"
#include "tests/support/frame/bundle_builder.hpp"

namespace lambent::frame {

struct KeyStage {
  std::filesystem::path path;
  World world;
  lighting::Environment environment;
  std::optional<Frame> frame;

  KeyStage(const testing::BundleBuilder& builder, const std::vector<spec::Light>& lights,
           std::uint32_t most_keys = FrameSettings::kAutoKeys, const FrameSettings& settings = {},
           spec::Size size = {64, 64})
      : path(std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}.lmb.glb", getpid(),
                         ::testing::UnitTest::GetInstance()->current_test_info()->name())),
        environment(*lighting::Environment::create(lights)) {
    environment.setMostKeys(most_keys);
    builder.write(path);
    const Result<std::uint32_t> opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    gpu::Counters counters;
    const Result<void> loaded = world.uploadAll(counters);
    EXPECT_TRUE(loaded) << loaded.error().line();
    FrameOptions options{.size = size, .output = Output::Linear, .settings = settings};
    options.settings.key_size = 1024;
    Result<Frame> made = Frame::create(options, environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }
  ~KeyStage() { std::filesystem::remove(path); }

  spec::RgbaImage picture(const spec::View& view) {
    render(view);
    return frame->readLinear();
  }
  void render(const spec::View& view) {
    const Result<void> done = frame->render(world, environment, view);
    ASSERT_TRUE(done) << done.error().line();
  }
  std::uint64_t mapsDrawn() const { return frame->counts()["key_maps_drawn"]; }
};

}  // namespace lambent::frame
