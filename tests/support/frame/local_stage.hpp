// Provides a stage for local lights: small bundles in the dark, lit by one light and drawn by the raster pass
// alone.
#pragma once

#include <cmath>
#include <functional>
#include <limits>
#include <numbers>
#include <optional>

#include <fmt/format.h>
#include <glm/geometric.hpp>
#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/lighting/environment.hpp"
#include "runtime/lighting/group_lights.hpp"
#include "runtime/shadows/local_shadows.hpp"
#include "runtime/surface/surfaces.hpp"
#include "tests/support/frame/bundle_builder.hpp"

namespace lambent::frame {

using lighting::LocalLight;
using testing::BuiltMesh;
using testing::BundleBuilder;
using testing::quadMesh;
using testing::sphereMesh;

inline constexpr float kPi = std::numbers::pi_v<float>;
inline constexpr std::uint32_t kSize = 64;

inline gltf::Material grey(float albedo) {
  gltf::Material material;
  material.base_color = glm::vec4(albedo, albedo, albedo, 1.0f);
  return material;
}

// Makes a horizontal square with edges of 2 `half` at this height, facing up.
inline BuiltMesh level(float y, float half, glm::vec2 center = {0, 0}, float albedo = 1.0f) {
  return {quadMesh(), grey(albedo),
          glm::translate(glm::mat4(1.0f), glm::vec3(center.x, y, center.y)) *
              glm::rotate(glm::mat4(1.0f), -0.5f * kPi, glm::vec3(1, 0, 0)) *
              glm::scale(glm::mat4(1.0f), glm::vec3(half))};
}

// Looks straight down on what is below y = `from`, 2 `half` wide; x points to the right and z downwards.
inline spec::View above(float half, float from = 0.9f) {
  return {.view_from_world = glm::lookAt(glm::vec3(0, from, 0), glm::vec3(0), glm::vec3(0, 0, -1)),
          .clip_from_view = glm::ortho(-half, half, -half, half, 0.0f, 20.0f),
          .eye_ws = {0, from, 0}};
}
inline float placeOf(std::uint32_t pixel, float half) {
  return half * (2.0f * (static_cast<float>(pixel) + 0.5f) / static_cast<float>(kSize) - 1.0f);
}

inline LocalLight sphereLight(glm::vec3 position, float radius, glm::vec3 radiance) {
  LocalLight light;
  light.kind = LocalLight::Kind::Sphere;
  light.position_ws = position;
  light.radius_m = radius;
  light.power = radiance;
  return light;
}

// Holds a bundle with a black environment, and the raster pass with local lights alone.
struct Stage {
  std::filesystem::path path;
  World world;
  lighting::Environment environment;
  evaluate::Samples samples;
  effects::diffuse::Diffuse diffuse;
  lighting::GroupLights group_lights;
  LocalShadows shadowed_lights;
  evaluate::SeenSky seen_sky;
  SurfaceModules modules;
  Surfaces surfaces{/*finest_texels=*/true, modules};
  gpu::Counters raster, shadows;
  std::vector<std::uint32_t> masks = {0xfu};

  explicit Stage(const BundleBuilder& builder, const LocalOptions& options = {}, float sky = 0.0f)
      : path(std::filesystem::path(::testing::TempDir()) /
             fmt::format("{}-{}.lmb.glb", getpid(),
                         ::testing::UnitTest::GetInstance()->current_test_info()->name())),
        environment(*lighting::Environment::create({spec::ConstantLight{.radiance = glm::vec3(sky)}})),
        shadowed_lights(options) {
    builder.write(path);
    const Result<std::uint32_t> opened = world.open(path);
    EXPECT_TRUE(opened) << opened.error().line();
    gpu::Counters counters;
    const Result<void> loaded = world.uploadAll(counters);
    EXPECT_TRUE(loaded) << loaded.error().line();
  }
  ~Stage() { std::filesystem::remove(path); }

  void update(std::span<const LocalLight> lights) {
    shadows = {};
    world.updateTransforms();
    const Result<void> done = shadowed_lights.update(world, lights, masks, shadows);
    ASSERT_TRUE(done) << done.error().line();
  }
  // Renders a picture; row 0 is the top. `plain` draws without local lights.
  std::vector<glm::vec4> picture(const spec::View& view, std::span<const LocalLight> lights,
                                 bool plain = false) {
    if (!plain) update(lights);
    world.updateTransforms();
    gpu::Counters counters;
    raster = {};
    std::vector<lighting::GroupPlace> places;
    for (std::size_t g = 0; g < world.residency().groups().size(); ++g)
      places.push_back({.world_from_group = world.rotationOf(g),
                        .order = world.residency().groups()[g].order,
                        .lamps = world.lampsOf(g)});
    group_lights.update(environment, sh::Window::Off, places, counters);
    constexpr auto kFull = evaluate::TransferMode::Full;
    EXPECT_TRUE(samples.shade(world.residency(), group_lights, kFull, counters));
    EXPECT_TRUE(diffuse.shade(world.residency(), group_lights, kFull, samples, counters));
    modules.clear();
    if (!plain) modules.push_back(&shadowed_lights);
    const Result<void> done = surfaces.prepare(world, diffuse, seen_sky, view, {}, raster);
    EXPECT_TRUE(done) << done.error().line();
    const gpu::Texture color("picture", {.format = GL_RGBA32F, .width = kSize, .height = kSize});
    const gpu::Texture depth("depth", {.format = GL_DEPTH_COMPONENT32F, .width = kSize, .height = kSize});
    const gpu::Framebuffer target("picture", color, &depth);
    target.bind();
    gpu::testDepth();
    target.clearColor({});
    target.clearDepth();
    if (!plain) shadowed_lights.bind(view, {kSize, kSize});
    surfaces.drawOpaque(world, raster);
    surfaces.drawBlended(world, raster);
    std::vector<glm::vec4> texels(kSize * kSize), result;
    glGetTextureImage(color.id(), 0, GL_RGBA, GL_FLOAT,
                      static_cast<GLsizei>(texels.size() * sizeof(glm::vec4)), texels.data());
    for (std::uint32_t y = kSize; y-- > 0;)
      result.insert(result.end(), texels.begin() + y * kSize, texels.begin() + (y + 1) * kSize);
    return result;
  }
  std::vector<glm::vec4> picture(const spec::View& view, const LocalLight& light) {
    return picture(view, std::span(&light, 1));
  }
};

// Compares every pixel with the expected value at its place (x, z).
inline void expectFloor(const std::vector<glm::vec4>& picture, float half, float tolerance,
                        const std::function<float(glm::vec2)>& expected, const std::string& what) {
  for (std::uint32_t y = 0; y < kSize; ++y)
    for (std::uint32_t x = 0; x < kSize; ++x) {
      const glm::vec2 place(placeOf(x, half), placeOf(y, half));
      const float wanted = expected(place);
      ASSERT_NEAR(picture[y * kSize + x].r, wanted, tolerance * wanted + 1e-7f)
          << what << " at " << place.x << " " << place.y;
    }
}

}  // namespace lambent::frame
