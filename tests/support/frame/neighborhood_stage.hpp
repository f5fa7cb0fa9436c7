// Shows a written scene in a world from straight above, and computes what its floor should show.
#pragma once

#include <cmath>
#include <filesystem>
#include <functional>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/frame/frame.hpp"
#include "runtime/sh/basis.hpp"
#include "runtime/sh/gaunt.hpp"
#include "runtime/sh/zonal.hpp"
#include "tests/support/frame/neighborhood_scene.hpp"

namespace lambent::testing {

struct NeighborhoodStage {
  static constexpr std::uint32_t kSide = 64;

  std::filesystem::path path;
  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;
  float half = 4.0f;  // half width of the picture in metres

  NeighborhoodStage(const NeighborhoodScene& scene, const std::vector<spec::Light>& lights,
                    bool neighborhoods = true)
      : path(std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}.lmb.glb", getpid(),
                         ::testing::UnitTest::GetInstance()->current_test_info()->name())),
        environment(*lighting::Environment::create(lights)) {
    scene.write(path);
    const Result<std::uint32_t> opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    if (!opened) std::abort();
    gpu::Counters counters;
    const Result<void> loaded = world.uploadAll(counters);
    EXPECT_TRUE(loaded) << loaded.error().line();
    frame::FrameOptions options;
    options.size = {kSide, kSide};
    options.output = frame::Output::Linear;
    options.settings.window = sh::Window::Off;
    options.settings.residual = false;
    options.settings.neighborhoods = neighborhoods;
    options.wait_for_captures = true;
    Result<frame::Frame> made = frame::Frame::create(options, environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }
  ~NeighborhoodStage() { std::filesystem::remove(path); }

  spec::View view() const {
    const glm::vec3 eye(0.0f, 50.0f, 0.0f);
    return {.view_from_world = glm::lookAt(eye, glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, -1.0f)),
            .clip_from_view = glm::ortho(-half, half, -half, half, 1.0f, 100.0f),
            .eye_ws = eye};
  }
  void render() {
    world.updateTransforms();
    const Result<void> done = frame->render(world, environment, view());
    ASSERT_TRUE(done) << done.error().line();
  }
  // Renders until everything is at rest, and returns the picture.
  spec::RgbaImage picture() {
    render();
    const Result<std::uint32_t> steps = frame->rest(world, environment);
    EXPECT_TRUE(steps) << steps.error().line();
    render();
    return frame->readLinear();
  }
  // Returns the pixel's place in world space, at height 0.
  glm::vec3 placeOf(std::uint32_t x, std::uint32_t y) const {
    const auto at = [&](std::uint32_t i) {
      return half * ((2.0f * static_cast<float>(i) + 1.0f) / kSide - 1.0f);
    };
    return {at(x), 0.0f, at(y)};
  }
  scene::Transform& edit(const std::string& name) {
    for (auto [entity, node] : world.registry().view<const scene::Name>())
      if (node.value == name && world.registry().has<scene::Transform>(entity))
        return world.registry().edit<scene::Transform>(entity);
    ADD_FAILURE() << "no " << name;
    static scene::Transform none;
    return none;
  }
  std::optional<gpu::Counters> counts(const std::string& pass) {
    frame->timers().finish();
    for (const gpu::PassTime& time : frame->timers().latest())
      if (time.name == pass) return time.counters;
    return {};
  }
};

// Returns (V - 1) L in this many bands, in world axes: what a body does to the light L if its change at the
// point is `change`.
inline std::vector<glm::vec3> changeOf(const sh::LightVector& light, int order, int bands_out,
                                       const std::vector<float>& change) {
  const sh::GauntTable table = sh::makeGauntTable(order, bands_out);
  std::vector<glm::vec3> out(static_cast<std::size_t>(bands_out * bands_out), glm::vec3(0.0f));
  for (std::size_t i = 0; i < out.size(); ++i)
    for (std::uint32_t t = table.offsets[i]; t < table.offsets[i + 1]; ++t)
      out[i] += table.terms[t].value * change[table.terms[t].k] * light.c[table.terms[t].j];
  return out;
}

// Returns E/pi at a normal from the light's bands.
inline glm::vec3 irradianceOverPi(const std::vector<glm::vec3>& light, const glm::vec3& normal) {
  const int bands = static_cast<int>(std::lround(std::sqrt(light.size())));
  std::vector<float> transfer(light.size());
  sh::unoccludedTransfer(bands, normal, transfer);
  glm::vec3 sum(0.0f);
  for (std::size_t i = 0; i < light.size(); ++i) sum += transfer[i] * light[i];
  return sum;
}

}  // namespace lambent::testing
