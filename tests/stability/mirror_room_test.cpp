// Tests mirrors in rooms from the scene through the baker to the frame: they show walls of known radiance.
#include <algorithm>

#include <gtest/gtest.h>

#include "runtime/frame/frame_parts.hpp"
#include "tests/stability/show.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using testing::add;
using testing::constantLight;
using testing::named;
using testing::Show;

const glm::vec3 kFront(0.8f, 0.1f, 0.1f), kRight(0.1f, 0.6f, 0.1f), kOtherWalls(0.2f, 0.2f, 0.5f);

// Makes a closed room of 2 m whose walls reflect nothing and shine, with a perfect mirror before its back.
assets::Scene mirrorRoom() {
  assets::Scene scene = named("mirror room");
  const auto wall = [&](const char* name, glm::vec3 corner, glm::vec3 right, glm::vec3 up,
                        glm::vec3 radiance) {
    add(scene, name, assets::plane(corner, right, up, 0.25f), glm::vec3(0.0f), {0, 0, 0}, false, radiance);
  };
  wall("floor", {-1, -1, 1}, {2, 0, 0}, {0, 0, -2}, kOtherWalls);
  wall("ceiling", {-1, 1, -1}, {2, 0, 0}, {0, 0, 2}, kOtherWalls);
  wall("back", {-1, -1, -1}, {2, 0, 0}, {0, 2, 0}, kOtherWalls);
  wall("front", {1, -1, 1}, {-2, 0, 0}, {0, 2, 0}, kFront);
  wall("left", {-1, -1, 1}, {0, 0, -2}, {0, 2, 0}, kOtherWalls);
  wall("right", {1, -1, -1}, {0, 0, 2}, {0, 2, 0}, kRight);
  add(scene, "mirror", assets::plane({-0.9f, -0.9f, -0.95f}, {1.8f, 0, 0}, {0, 1.8f, 0}, 0.2f),
      glm::vec3(1.0f), {0, 0, 0}, false);
  scene.materials.back().metallic = 1.0f;
  scene.materials.back().roughness = 0.0f;
  return scene;
}

void expectNear(const glm::vec3& seen, const glm::vec3& radiance, const char* what) {
  // The table of b(v) reflects a percent less or more than all light.
  for (int i = 0; i < 3; ++i)
    EXPECT_NEAR(seen[i], radiance[i], 0.03f * radiance[i] + 0.005f) << what << " " << i;
}

using MirrorRoom = testing::GpuTest;

TEST_F(MirrorRoom, ShowsTheWallThatTheRayMeetsAndNotTheOneInItsDirection) {
  Show show(mirrorRoom(), {constantLight(1.0f)});
  expectNear(show.patch({-0.3f, 0.1f, 0.5f}, {-0.3f, 0.0f, -0.95f}), kFront, "straight on");
  // The mirrored ray meets the right wall 0.42 m before the mirror. From the middle of the room its direction
  // is one to the front wall.
  expectNear(show.patch({-0.3f, 0.1f, 0.45f}, {0.7f, 0.05f, -0.95f}), kRight, "aslant");
  EXPECT_EQ(show.frame->parts().probes.places().size(), 1u);
}

// A probe inside must not show its room to the other side of the walls, which have no thickness.
TEST_F(MirrorRoom, TheOutsideOfABoxWithoutALidMirrorsTheSky) {
  assets::Scene scene = named("box");
  const auto wall = [&](const char* name, glm::vec3 corner, glm::vec3 right, glm::vec3 up) {
    add(scene, name, assets::plane(corner, right, up, 0.25f), glm::vec3(0.05f), {0, 0, 0}, false);
    scene.materials.back().roughness = 0.0f;
    scene.materials.back().specular = 1.0f;
    scene.materials.back().double_sided = true;
  };
  wall("floor", {-1, -1, 1}, {2, 0, 0}, {0, 0, -2});
  wall("back", {-1, -1, -1}, {2, 0, 0}, {0, 2, 0});
  wall("front", {1, -1, 1}, {-2, 0, 0}, {0, 2, 0});
  wall("left", {-1, -1, 1}, {0, 0, -2}, {0, 2, 0});
  wall("right", {1, -1, -1}, {0, 0, 2}, {0, 2, 0});
  Show show(scene, {constantLight(1.0f)});
  const glm::vec3 eye(2.5f, 0.5f, 1.6f), target(0.2f, 0.1f, 1.0f);
  const glm::vec3 on = show.patch(eye, target);
  EXPECT_FALSE(show.frame->parts().probes.places().empty());
  frame::FrameSettings settings = show.frame->settings();
  settings.reflection_probes = 0;
  ASSERT_TRUE(show.frame->setSettings(settings));
  EXPECT_EQ(show.patch(eye, target), on);
}

TEST_F(MirrorRoom, ABallUnderTheOpenSkyHasNoProbesAndTheSamePicture) {
  assets::Scene scene = named("ball");
  add(scene, "ball", assets::sphere(1.0f, 12), glm::vec3(1.0f), glm::vec3(0.0f), /*movable=*/false);
  add(scene, "floor", assets::plane({-3, -1, 3}, {6, 0, 0}, {0, 0, -6}, 0.5f), glm::vec3(0.5f), {0, 0, 0},
      false);
  for (assets::Material& material : scene.materials) {
    material.roughness = 0.2f;
    material.specular = 1.0f;
  }
  Show show(scene, {constantLight(1.0f)});
  const glm::vec3 eye(0.5f, 1.5f, 4.0f), target(0.4f, 0.3f, 0.8f);
  const glm::vec3 on = show.patch(eye, target);
  const auto& draws = show.world.residency().draws();
  EXPECT_TRUE(std::ranges::all_of(draws, &streaming::ResidentDraw::layered)) << "both are mirrors";
  EXPECT_TRUE(show.frame->parts().probes.places().empty());
  frame::FrameSettings settings = show.frame->settings();
  settings.reflection_probes = 0;
  ASSERT_TRUE(show.frame->setSettings(settings));
  EXPECT_EQ(show.patch(eye, target), on);
}

}  // namespace
}  // namespace lambent
