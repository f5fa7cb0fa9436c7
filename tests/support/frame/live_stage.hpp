// Shows a written bundle in a world with a light and a frame of 64 x 64 linear pixels. A test can change
// everything while it is shown.
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
#include "runtime/scene/materials.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/bundle_builder.hpp"

namespace lambent::testing {

struct LiveStage {
  std::filesystem::path path;
  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;
  spec::OrbitCamera camera{
      .azimuth_deg = 20.0f, .elevation_deg = 15.0f, .distance_radii = 2.5f, .fov_deg = 40.0f};

  LiveStage(const BundleBuilder& builder, const std::vector<spec::Light>& lights,
            const frame::FrameSettings& settings = {})
      : path(std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}.lmb.glb", getpid(),
                         ::testing::UnitTest::GetInstance()->current_test_info()->name())),
        environment(*lighting::Environment::create(lights)) {
    builder.write(path);
    const Result<std::uint32_t> opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    if (!opened) return;
    gpu::Counters counters;
    const Result<void> loaded = world.uploadAll(counters);
    EXPECT_TRUE(loaded) << loaded.error().line();
    Result<frame::Frame> made = frame::Frame::create(
        {.size = {64, 64}, .output = frame::Output::Linear, .settings = settings, .wait_for_captures = true},
        environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }
  ~LiveStage() { std::filesystem::remove(path); }

  spec::View view() {
    world.updateTransforms();
    const scene::Box bounds = scene::worldBounds(world.registry());
    return spec::orbitView(camera, bounds.min, bounds.max, 1.0f);
  }
  void render() {
    const Result<void> done = frame->render(world, environment, view());
    ASSERT_TRUE(done) << done.error().line();
  }
  // Renders until everything is at rest, and returns the picture.
  std::vector<glm::vec4> picture() {
    render();
    const Result<std::uint32_t> steps = frame->rest(world, environment);
    EXPECT_TRUE(steps) << steps.error().line();
    render();
    return frame->readLinear().texels;
  }
  void set(std::string_view name, std::string_view word) {
    frame::FrameSettings settings = frame->settings();
    const Result<void> put = frame::putSetting(settings, name, word);
    ASSERT_TRUE(put) << put.error().line();
    const Result<void> set = frame->setSettings(settings);
    ASSERT_TRUE(set) << set.error().line();
  }
  scene::MaterialComponent& editMaterial(std::size_t index) {
    return world.registry().edit<scene::MaterialComponent>(world.instance(0).materials[index]);
  }
  // Returns the time of a pass of the last frame, or none if there was no such pass.
  std::optional<gpu::PassTime> pass(const std::string& name) {
    frame->timers().finish();
    for (const gpu::PassTime& time : frame->timers().latest())
      if (time.name == name) return time;
    return {};
  }
  std::string reason(const std::string& name) {
    const auto found = pass(name);
    EXPECT_TRUE(found) << name;
    return found ? found->reason : "";
  }
};

// Returns the largest difference in any channel.
inline float farthest(const std::vector<glm::vec4>& a, const std::vector<glm::vec4>& b) {
  float most = a.size() == b.size() ? 0.0f : 1e9f;
  for (std::size_t i = 0; i < std::min(a.size(), b.size()); ++i)
    for (int k = 0; k < 4; ++k) most = larger(most, std::abs(a[i][k] - b[i][k]));
  return most;
}

}  // namespace lambent::testing
