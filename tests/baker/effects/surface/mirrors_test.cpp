// Tests light that comes by way of sharp metals (baker/trace/mirror_paths.hpp) against mirror images and what
// mirrors conserve.
#include <cmath>
#include <numbers>

#include <glm/gtc/matrix_transform.hpp>
#include <gtest/gtest.h>

#include "baker/plan/smooth_dielectrics.hpp"
#include "baker/trace/mirror_paths.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/glossy_transport.hpp"

namespace lambent::baker {
namespace {

using testing::bakeGlossy;
using testing::GlossyBake;
using testing::GlossyBakeSettings;
using testing::grid;
using testing::icosphere;
using testing::sceneOf;
using testing::transformed;
using testing::Transport;
using testing::turned;
using testing::uniformRadiance;

constexpr float kUniformLight = 3.54490770f;

// Adds a mesh of a metal to a scene.
void addMetal(bundle::MeshData mesh, float roughness, const glm::vec3& color, Scene& scene) {
  gltf::Material metal = scene.materials[0];
  metal.base_color = glm::vec4(color, 1.0f);
  metal.metallic = 1.0f;
  metal.double_sided = true;
  metal.roughness = roughness;
  testing::addNode(scene).mesh = static_cast<std::int32_t>(scene.meshes.size());
  scene.meshes.push_back({"", {{std::move(mesh), static_cast<std::int32_t>(scene.materials.size())}}});
  scene.materials.push_back(metal);
}

// Makes a ring about the y axis that stands on the floor, of radius 1; its material must have two sides.
bundle::MeshData ring(float height, int around) {
  return turned(testing::ring(height, around), -90.0f, {1, 0, 0});
}

// A scene with metals, whose rays follow mirrors unless told otherwise.
struct Room {
  explicit Room(const Scene& scene, bool follow = true)
      : transport(scene, true),
        surfaces(transport),
        mirrors(transport.geometry, transport.rays, transport.colors, surfaces.brdfs,
                !transport.lights.empty()) {
    if (follow) transport.mirrors = &mirrors;
  }
  GlossyBake bake(const GlossyBakeSettings& settings) const {
    return bakeGlossy(transport, surfaces.kernels(), settings);
  }
  // The sum of direct light and bounces at the diffuse sample nearest to a place.
  std::vector<float> transferAt(const GlossyBake& baked, const glm::vec3& place) const {
    const std::size_t s = transport.sampleAt(place);
    EXPECT_LT(s, transport.samples.glossy.begin);
    std::vector<float> sum(baked.direct.field.at(s).begin(), baked.direct.field.at(s).end());
    for (std::size_t i = 0; i < sum.size(); ++i) sum[i] += baked.bounced.field.at(s)[i];
    return sum;
  }

  Transport transport;
  testing::TransportBrdfs surfaces;
  MirrorPaths mirrors;
};

// A black floor, so small that the wall hardly sees it, and a wall of `size` m with n x n cells 0.5 m beside
// it.
Scene wallBesideAFloor(float roughness, float size, int n) {
  Scene scene = sceneOf({grid({0, 0, 0}, 0.1f, 2)});
  scene.materials[0].base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  addMetal(transformed(turned(grid({0, 0, 0}, size, n), -90.0f, {0, 0, 1}),
                       glm::translate(glm::mat4(1.0f), {-0.5f, 0.5f * size - 0.1f, 0})),
           roughness, glm::vec3(1.0f), scene);
  return scene;
}

TEST(Mirrors, AreFollowedWhereSevenBandsCarryLessThanHalfOfAHighlight) {
  EXPECT_LT(lobeEnergyShare(double{kMirrorRoughness}, 7), 0.5);
}

TEST(Mirrors, BesideAFloorShowItTheOtherHalfOfTheSky) {
  const Room room(wallBesideAFloor(/*roughness=*/0.0f, /*size=*/400.0f, /*n=*/2));
  const auto transfer = room.transferAt(room.bake({.rays = 4096, .bounces = 1}), {0, 0, 0});
  // By the image method, light from s with s.x < 0 is that from s with x turned round.
  std::array<double, 25> expected{};
  std::array<float, 25> y{};
  constexpr int kSteps = 400;
  for (int i = 0; i < kSteps; ++i)
    for (int j = 0; j < 2 * kSteps; ++j) {
      // Equal shares of the cosine-weighted hemisphere.
      const double square = (i + 0.5) / kSteps,
                   turn = 2.0 * double{std::numbers::pi_v<float>} * (j + 0.5) / (2 * kSteps);
      const double r = std::sqrt(square);
      sh::evaluate(5, glm::vec3(std::abs(r * std::cos(turn)), std::sqrt(1.0 - square), r * std::sin(turn)),
                   y);
      for (std::size_t k = 0; k < y.size(); ++k) expected[k] += double{y[k]} / (2.0 * kSteps * kSteps);
    }
  // Rays are few where the mirror ends at the horizon.
  for (std::size_t k = 0; k < expected.size(); ++k) EXPECT_NEAR(double{transfer[k]}, expected[k], 0.003) << k;
  EXPECT_GT(std::abs(expected[3]), 0.1);  // the half of the sky matters
}

TEST(Mirrors, OfARingLeaveLightAboutItsAxisAsItIs) {
  // Vertical mirrors keep the height of every direction and lose nothing, so light that depends on height
  // alone arrives as if there were no ring, however often it is reflected.
  Scene scene = sceneOf({grid({0, 0, 0}, 3.0f, 8)});
  scene.materials[0].base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  addMetal(ring(0.7f, 96), 0.0f, glm::vec3(1.0f), scene);
  const Room room(scene), kernels(scene, /*follow=*/false);
  const GlossyBake baked = room.bake({.rays = 2048, .bounces = 1}),
                   blurred = kernels.bake({.rays = 2048, .bounces = 8});
  std::array<float, 25> open{};
  sh::unoccludedTransfer(5, glm::vec3(0, 1, 0), std::span<float>(open));
  double others = 0.0, off = 0.0;
  for (const glm::vec3 place : {glm::vec3(0), glm::vec3(0.375f, 0, 0.375f), glm::vec3(1.5f, 0, 0)}) {
    const auto transfer = room.transferAt(baked, place), by_kernels = kernels.transferAt(blurred, place);
    // The mean over the azimuth is what a function of height keeps: project on zonal functions about y.
    for (int l = 0; l < 5; ++l) {
      std::array<float, 25> zonal{};
      sh::evaluate(5, glm::vec3(0, 1, 0), zonal);
      double got = 0.0, expected = 0.0, of_kernels = 0.0;
      for (int k = l * l; k < (l + 1) * (l + 1); ++k) {
        const auto i = static_cast<std::size_t>(k);
        got += double{zonal[i]} * double{transfer[i]};
        expected += double{zonal[i]} * double{open[i]};
        of_kernels += double{zonal[i]} * double{by_kernels[i]};
      }
      EXPECT_NEAR(got, expected, 0.006) << "x " << place.x << " band " << l;
      off = testing::larger(off, std::abs(of_kernels - expected));
    }
    for (std::size_t k = 0; k < 25; ++k)
      others = testing::larger(others, std::abs(double{transfer[k]} - double{open[k]}));
  }
  EXPECT_GT(others, 0.02);  // light from one side is focused
  EXPECT_GT(off, 0.02);     // and kernels of five bands do not do this
}

TEST(Mirrors, InAWhiteFurnaceLeaveUniformLightAsItIs) {
  for (const float roughness : {0.0f, 0.1f}) {
    Scene scene = sceneOf({grid({0, 0, 0}, 3.0f, 8)});
    addMetal(icosphere({0, 0.6f, 0}, 0.5f, 2), roughness, glm::vec3(1.0f), scene);
    addMetal(icosphere({0.9f, 0.4f, 0.4f}, 0.35f, 2), roughness, glm::vec3(1.0f), scene);
    const Room room(scene);
    const GlossyBake baked = room.bake({.rays = 256, .bounces = 8});
    for (std::size_t s = 0; s < room.transport.samples.glossy.begin; ++s) {
      const float sum =
          uniformRadiance(baked.direct.field.at(s)) + uniformRadiance(baked.bounced.field.at(s));
      EXPECT_NEAR(sum, 1.0f, 0.01f) << "roughness " << roughness;
    }
  }
}

TEST(Mirrors, HavePathsThatAreTheSameWhenTracedAgain) {
  Scene scene = sceneOf({grid({0, 0, 0}, 3.0f, 8)});
  addMetal(ring(0.5f, 24), 0.2f, {1.0f, 0.8f, 0.4f}, scene);
  const Room room(scene);
  const GlossyBake kept = room.bake({.rays = 256, .bounces = 3}),
                   again = room.bake({.rays = 256, .bounces = 3, .hit_memory = 0});
  EXPECT_EQ(kept.bounced.field.vectors, again.bounced.field.vectors);
  EXPECT_EQ(kept.direct.glossy.bounced, again.direct.glossy.bounced);
}

TEST(Mirrors, TakeTheColourOfTheMetal) {
  const glm::vec3 gold(1.0f, 0.5f, 0.25f);
  Scene scene = sceneOf({grid({0, 0, 0}, 3.0f, 8)});
  scene.materials[0].base_color = glm::vec4(0.0f, 0.0f, 0.0f, 1.0f);
  addMetal(icosphere({0, 0.6f, 0}, 0.5f, 2), 0.0f, gold, scene);
  const Room room(scene);
  const GlossyBake baked = room.bake({.rays = 256, .bounces = 1});
  const auto bounced = baked.bounced.field.at(room.transport.sampleAt({0.75f, 0, 0}));
  ASSERT_EQ(baked.bounced.field.channels, 3u);
  const float white = bounced[0];
  EXPECT_GT(kUniformLight * white, 0.01f);
  for (const int c : {1, 2}) {
    const float share = bounced[static_cast<std::size_t>(25 * c)] / white;
    EXPECT_GT(share, gold[c] - 0.01f);
    EXPECT_LT(share, gold[c] + 0.3f * (1.0f - gold[c]));
  }
}

// Half of this surface is a metal: its base sends light too. Under uniform light five bands of a kernel lose
// nothing where nearly all is open.
TEST(Mirrors, OfHalfAMetalSendAsMuchLightAsTheirKernels) {
  Scene scene = wallBesideAFloor(/*roughness=*/0.2f, /*size=*/8.0f, /*n=*/4);
  scene.materials[1].metallic = 0.5f;
  scene.materials[1].base_color = {0.9f, 0.9f, 0.9f, 1.0f};
  const auto of = [&](bool follow) {
    const Room room(scene, follow);
    const GlossyBake baked = room.bake({.rays = 1024, .bounces = 1});
    return uniformRadiance(baked.bounced.field.at(room.transport.sampleAt({0, 0, 0})));
  };
  const float by_kernels = of(false);
  EXPECT_GT(by_kernels, 0.2f);
  EXPECT_NEAR(of(true), by_kernels, 0.01f * by_kernels);
}

// A path never meets a lamp that is a point, so its light leaves the mirror by the kernel.
TEST(Mirrors, SendOnTheLightOfPointLampsByTheirKernels) {
  Scene scene = wallBesideAFloor(/*roughness=*/0.2f, /*size=*/2.0f, /*n=*/12);
  testing::addPointLight(scene, {0.5f, 0.5f, 0.0f});
  const Room room(scene), kernels(scene, /*follow=*/false);
  ASSERT_EQ(room.transport.lights.size(), 1u);
  const auto of = [](const Room& r) {
    const GlossyBake baked = r.bake({.rays = 4096, .bounces = 1});
    return double{baked.bounced.field.at(r.transport.sampleAt({0, 0, 0}))[25]};
  };
  const double expected = of(kernels);
  EXPECT_GT(expected, 0.001);
  // Corners are interpolated here, and dealt out there.
  EXPECT_NEAR(of(room), expected, 0.05 * expected);
}

}  // namespace
}  // namespace lambent::baker
