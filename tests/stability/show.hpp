// Takes a scene from its description through the baker to the frame, and renders pictures of a few pixels.
#pragma once

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "assets/glb.hpp"
#include "assets/shapes.hpp"
#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "reference/reference.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/scene/instantiate.hpp"

namespace lambent::testing {

// Holds a baked scene in a world with a light, and renders it at a small size.
class Show {
 public:
  Show(const assets::Scene& source, const std::vector<spec::Light>& lights, int light_probes = 0,
       std::optional<int> bounces = {}, float error_bound = 0.0f)
      : environment(*lighting::Environment::create(lights)) {
    const auto folder =
        std::filesystem::path(::testing::TempDir()) /
        (std::to_string(::getpid()) + "-" + ::testing::UnitTest::GetInstance()->current_test_info()->name());
    std::filesystem::create_directories(folder);
    const std::filesystem::path file = folder / "scene.glb", bundle = folder / "scene.lmb.glb";
    EXPECT_TRUE(assets::writeGlb(file, source));
    auto imported = baker::importScene(file);
    EXPECT_TRUE(imported) << imported.error().line();
    scene = std::move(*imported);
    baker::BakeOptions options;
    options.quality = baker::Quality::Draft;
    options.light_probes = light_probes;
    if (bounces) options.bounces = *bounces;
    options.error_bound = error_bound;
    baker::Progress progress;
    const auto report = baker::bake(scene, options, bundle, {progress});
    EXPECT_TRUE(report) << report.error().line();
    const Result<std::uint32_t> opened = world.open(bundle);
    EXPECT_TRUE(opened) << opened.error().line();
    gpu::Counters counters;
    EXPECT_TRUE(world.uploadAll(counters));
    std::filesystem::remove_all(folder);
    frame::FrameOptions frame_options;
    frame_options.size = {kSide, kSide};
    frame_options.output = frame::Output::Linear;
    frame_options.settings.window = sh::Window::Off;
    frame_options.wait_for_captures = true;
    auto made = frame::Frame::create(frame_options, environment);
    EXPECT_TRUE(made) << made.error().line();
    frame.emplace(std::move(*made));
  }

  // Returns the mean of a small patch around `target`, once the light is at rest, which must happen within
  // this many pictures. All pixels must be finite.
  glm::vec3 patch(glm::vec3 eye, glm::vec3 target, std::uint32_t pictures = 1) {
    step(eye, target);
    std::uint32_t steps = frame::kMaxRestSteps;
    for (std::uint32_t times = 0; times < pictures && steps == frame::kMaxRestSteps; ++times) {
      const Result<std::uint32_t> taken = frame->rest(world, environment);
      EXPECT_TRUE(taken) << taken.error().line();
      if (!taken) return {};
      steps = *taken;
    }
    EXPECT_LT(steps, frame::kMaxRestSteps) << "does not come to rest";
    step(eye, target);
    glm::dvec3 sum(0.0);
    for (const glm::vec4& texel : frame->readLinear().texels) {
      EXPECT_TRUE(std::isfinite(texel.r) && std::isfinite(texel.g) && std::isfinite(texel.b));
      sum += glm::dvec3(texel);
    }
    return glm::vec3(sum / double{kSide * kSide});
  }
  static spec::View viewOf(glm::vec3 eye, glm::vec3 target) {
    return {.view_from_world = glm::lookAt(eye, target, glm::vec3(0.01f, 1.0f, 0.02f)),
            .clip_from_view = glm::perspective(glm::radians(1.5f), 1.0f, 0.01f, 1000.0f),
            .eye_ws = eye};
  }
  void step(glm::vec3 eye, glm::vec3 target) {
    world.updateTransforms();
    const Result<void> done = frame->render(world, environment, viewOf(eye, target));
    ASSERT_TRUE(done) << done.error().line();
  }

  // Returns what the path-traced reference shows of such a patch, in green.
  double referenceAt(glm::vec3 eye, glm::vec3 target, const std::vector<spec::Light>& lights,
                     std::uint32_t samples) const {
    baker::reference::Request request;
    request.lights = lights;
    request.view = viewOf(eye, target);
    request.options.size = {kSide, kSide};
    request.options.spp = samples;
    baker::Progress progress;
    const auto report = baker::reference::render(scene, request, {}, true, progress, {});
    EXPECT_TRUE(report) << report.error().line();
    double sum = 0.0;
    for (const glm::vec4& texel : report->image.texels) sum += double{texel.g} / (kSide * kSide);
    return sum;
  }

  void move(const std::string& name, glm::vec3 to) {
    scene::Transform* transform = nullptr;
    for (auto [entity, node] : world.registry().view<const scene::Name>())
      if (node.value == name && world.registry().has<scene::Transform>(entity))
        transform = &world.registry().edit<scene::Transform>(entity);
    ASSERT_NE(transform, nullptr) << name;
    transform->translation = to;
  }
  void add(const scene::LocalLightComponent& light, glm::vec3 at) {
    const ecs::Entity entity = world.registry().create();
    world.registry().emplace<scene::Transform>(entity).translation = at;
    world.registry().emplace<scene::LocalLightComponent>(entity, light);
  }

  static constexpr std::uint32_t kSide = 8;
  baker::Scene scene;  // as imported
  frame::World world;
  lighting::Environment environment;
  std::optional<frame::Frame> frame;
};

inline spec::Light constantLight(float radiance) {
  return spec::ConstantLight{.radiance = glm::vec3(radiance)};
}

inline assets::Scene named(const std::string& name) {
  assets::Scene scene;
  scene.name = name;
  return scene;
}

// Adds a body with a material of its own, and with a rigid group of its own if it is movable.
inline void add(assets::Scene& scene, const std::string& name, assets::Mesh mesh, glm::vec3 color,
                glm::vec3 at, bool movable, glm::vec3 emission = glm::vec3(0.0f)) {
  scene.materials.push_back({.name = name, .base_color = color, .emission = emission});
  scene.meshes.push_back({name, std::move(mesh), static_cast<int>(scene.materials.size()) - 1});
  assets::Node node{.name = name, .mesh = static_cast<int>(scene.meshes.size()) - 1, .translation = at};
  node.movable = movable;
  scene.nodes.push_back(node);
}

}  // namespace lambent::testing
