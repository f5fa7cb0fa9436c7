// Shows worlds of several bundles under one light from above, and writes files for them: a floor, a ball over
// it that changes the floor's light (by a grid, and as captures see it), a sheet, a cloud.
#pragma once

#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <string>
#include <vector>

#include <fmt/format.h>
#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/frame/frame.hpp"
#include "runtime/scene/components.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/frame/bundle_builder.hpp"
#include "tests/support/frame/neighborhood_scene.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent::testing {

inline double worst(const spec::RgbaImage& a, const spec::RgbaImage& b) {
  double largest = 0.0;
  for (std::size_t i = 0; i < a.texels.size(); ++i)
    largest = larger(largest, double{glm::distance(a.texels[i], b.texels[i])});
  return largest;
}

struct WorldStage {
  static constexpr std::uint32_t kSide = 64;

  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;

  explicit WorldStage(const std::vector<spec::Light>& lights, const frame::WorldOptions& options = {})
      : world(options), environment(*lighting::Environment::create(lights)) {
    uploadAtMost(1);  // one item a frame
  }
  void uploadAtMost(std::uint64_t upload_budget_bytes) {
    frame::FrameOptions frame_options;
    frame_options.size = {kSide, kSide};
    frame_options.output = frame::Output::Linear;
    frame_options.wait_for_captures = true;
    frame_options.upload_budget_bytes = upload_budget_bytes;
    Result<frame::Frame> made = frame::Frame::create(frame_options, environment);
    EXPECT_TRUE(made) << made.error().line();
    if (made) frame.emplace(std::move(*made));
  }

  std::uint32_t open(const std::filesystem::path& path, const frame::OpenOptions& options = {}) {
    const Result<std::uint32_t> slot = world.open(path, options);
    EXPECT_TRUE(slot) << slot.error().line();
    return slot.value_or(~0u);
  }
  void render() {
    const glm::vec3 eye(0.0f, 20.0f, 0.0f);
    const spec::View view{.view_from_world = glm::lookAt(eye, glm::vec3(0.0f), glm::vec3(0.0f, 0.0f, -1.0f)),
                          .clip_from_view = glm::ortho(-3.0f, 3.0f, -3.0f, 3.0f, 1.0f, 100.0f),
                          .eye_ws = eye};
    renderFrom(view);
  }
  void renderFrom(const spec::View& view) {
    world.updateTransforms();
    const Result<void> done = frame->render(world, environment, view);
    ASSERT_TRUE(done) << done.error().line();
  }
  // Uploads everything, waits until the light is at rest, and returns the picture.
  spec::RgbaImage picture() {
    gpu::Counters counters;
    (void)world.uploadAll(counters);  // errors of a bundle are in errors()
    render();
    const Result<std::uint32_t> steps = frame->rest(world, environment);
    EXPECT_TRUE(steps) << steps.error().line();
    render();
    return frame->readLinear();
  }
  ecs::Entity node(const std::string& name) {
    for (auto [entity, found] : world.registry().view<const scene::Name>())
      if (found.value == name && world.registry().has<scene::Transform>(entity)) return entity;
    ADD_FAILURE() << "no " << name;
    return {};
  }
};

class WorldTest : public GpuTest {
 protected:
  // Expects the same picture and the same memory use.
  static void expectSame(const spec::RgbaImage& image, const spec::RgbaImage& expected, WorldStage&) {
    EXPECT_EQ(worst(image, expected), 0.0);
  }
  struct Fresh {
    spec::RgbaImage image;
    std::uint64_t bytes = 0;
  };
  void expectSame(const spec::RgbaImage& image, const Fresh& fresh, WorldStage& stage) {
    EXPECT_EQ(worst(image, fresh.image), 0.0);
    EXPECT_EQ(stage.world.residency().bytesResident(), fresh.bytes);
    EXPECT_EQ(stage.frame->counts()["cells_shaded"], 0u) << "at rest";
  }
  Fresh fresh(const std::vector<std::filesystem::path>& files) {
    WorldStage stage(lights);
    for (const std::filesystem::path& path : files) stage.open(path);
    spec::RgbaImage image = stage.picture();
    return {std::move(image), stage.world.residency().bytesResident()};
  }

  void SetUp() override {
    GpuTest::SetUp();
    std::filesystem::create_directories(folder);
  }
  void TearDown() override {
    GpuTest::TearDown();
    std::filesystem::remove_all(folder);
  }
  std::filesystem::path file(const std::string& name) const { return folder / name; }

  std::filesystem::path floorFile() {
    const std::filesystem::path path = file("floor.lmb.glb");
    if (std::filesystem::exists(path)) return path;
    NeighborhoodScene scene;
    scene.receivers = {{.name = "floor", .mesh = floorMesh(2.5f, 24)},
                       {.name = "step", .mesh = floorMesh(0.6f, 4)}};
    scene.receivers[1].place = {1.5f, 0.4f, 0.0f};
    scene.write(path);
    return path;
  }
  std::filesystem::path ballFile(float x) {
    const std::filesystem::path path = file(fmt::format("ball-{}.lmb.glb", x));
    if (std::filesystem::exists(path)) return path;
    NeighborhoodScene scene;
    scene.bodies = {{.change = blackSphere(0.5f), .size = glm::uvec3(9), .half = glm::vec3(1.5f)}};
    scene.bodies[0].sphere_radius = 0.5f;
    scene.bodies[0].place = {x, 0.8f, 0.0f};
    scene.receivers = {{.name = "lid", .mesh = floorMesh(0.3f, 2)}};
    scene.receivers[0].place = {x, 1.4f, 0.0f};
    scene.write(path);
    return path;
  }
  std::filesystem::path quadFile(const glm::vec4& color) {
    const std::filesystem::path path = file(fmt::format("quad-{}.lmb.glb", color.r));
    if (std::filesystem::exists(path)) return path;
    gltf::Material material;
    material.base_color = color;
    const glm::mat4 lying = glm::rotate(glm::translate(glm::mat4(1.0f), glm::vec3(-1.8f, 1.0f, 1.0f)),
                                        glm::radians(-90.0f), glm::vec3(1, 0, 0));
    BundleBuilder().add({quadMesh(), material, lying}).write(path);
    return path;
  }
  std::filesystem::path mistFile() {
    const std::filesystem::path path = file("mist.lmb.glb");
    if (std::filesystem::exists(path)) return path;
    BuiltVolume mist;
    mist.density = [](const glm::vec3& grid) { return 0.2f + 0.05f * grid.x; };
    mist.rest_translation = {1.0f, 2.0f, -1.0f};
    BundleBuilder().volume(mist).write(path);
    return path;
  }

  const std::filesystem::path folder =
      std::filesystem::path(::testing::TempDir()) /
      fmt::format("{}-{}", getpid(), ::testing::UnitTest::GetInstance()->current_test_info()->name());
  const std::vector<spec::Light> lights = {
      spec::SunLight{.azimuth_deg = 60, .elevation_deg = 50, .angle_deg = 10, .radiance = glm::vec3(20.0f)},
      spec::ConstantLight{.radiance = glm::vec3(0.5f, 0.6f, 0.8f)}};
};

}  // namespace lambent::testing
