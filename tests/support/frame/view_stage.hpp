// Shows one written bundle in a world with a light and a small square frame.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
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

  // Without `load`, the bundle streams in with the frames.
  ViewStage(const BundleBuilder& builder, const std::vector<spec::Light>& lights,
            frame::FrameOptions options = {}, bool load = true, const frame::WorldOptions& world_options = {},
            std::uint32_t side = 64)
      : path(std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}{}.lmb.glb", getpid(),
                         ::testing::UnitTest::GetInstance()->current_test_info()->name(),
                         load ? "" : "-streamed")),
        world(world_options),
        environment(*lighting::Environment::create(lights)) {
    builder.write(path);
    const Result<std::uint32_t> opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    gpu::Counters counters;
    if (load) {
      const Result<void> loaded = world.uploadAll(counters);
      EXPECT_TRUE(loaded) << loaded.error().line();
    }
    options.size = {side, side};
    options.wait_for_captures = true;
    Result<frame::Frame> made = frame::Frame::create(options, environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }
  ~ViewStage() { std::filesystem::remove(path); }

  spec::View view() {
    world.updateTransforms();
    const scene::Box bounds = scene::worldBounds(world.registry());
    return spec::orbitView(camera, bounds.min, bounds.max, 1.0f);
  }
  void render() { render(view()); }
  void render(const spec::View& view) {
    const Result<void> done = frame->render(world, environment, view);
    ASSERT_TRUE(done) << done.error().line();
  }
  spec::RgbaImage picture() {
    render();
    return frame->readLinear();
  }
  // Returns the time of a pass of the last frame, or none if there was no such pass.
  std::optional<gpu::PassTime> pass(const std::string& name) {
    frame->timers().finish();
    for (const gpu::PassTime& time : frame->timers().latest())
      if (time.name == name) return time;
    return {};
  }
};

}  // namespace lambent::testing
