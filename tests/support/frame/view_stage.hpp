// Shows one bundle in a world with a light and a frame of 64 x 64, for tests of views and overlays.
#pragma once

#include <filesystem>
#include <optional>
#include <vector>

#include <fmt/format.h>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/frame/frame.hpp"
#include "runtime/scene/bounds.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::testing {

// Returns options for pictures that are compared as linear light or as numbers.
inline frame::FrameOptions linearOptions(const frame::ViewChoice& view = {}) {
  frame::FrameOptions options;
  options.output = frame::Output::Linear;
  options.view = view;
  return options;
}

struct ViewStage {
  std::filesystem::path path;
  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;
  spec::OrbitCamera camera{
      .azimuth_deg = 0.0f, .elevation_deg = 0.0f, .distance_radii = 2.5f, .fov_deg = 40.0f};

  ViewStage(const BundleBuilder& builder, const std::vector<spec::Light>& lights, frame::FrameOptions options)
      : path(std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}.lmb.glb", getpid(),
                         ::testing::UnitTest::GetInstance()->current_test_info()->name())),
        environment(*lighting::Environment::create(lights)) {
    builder.write(path);
    const auto opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    gpu::Counters counters;
    const Result<void> loaded = world.uploadAll(counters);
    EXPECT_TRUE(loaded) << loaded.error().line();
    options.size = {64, 64};
    options.wait_for_captures = true;
    Result<frame::Frame> made = frame::Frame::create(options, environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }
  ~ViewStage() { std::filesystem::remove(path); }

  void render() {
    world.updateTransforms();
    const scene::Box bounds = scene::worldBounds(world.registry());
    const Result<void> done =
        frame->render(world, environment, spec::orbitView(camera, bounds.min, bounds.max, 1.0f));
    ASSERT_TRUE(done) << done.error().line();
  }
  spec::RgbaImage picture() {
    render();
    return frame->readLinear();
  }
};

}  // namespace lambent::testing
