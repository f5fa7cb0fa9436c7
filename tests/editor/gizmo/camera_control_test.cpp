#include "editor/gizmo/camera_control.hpp"

#include <cmath>

#include <gtest/gtest.h>

#include "editor/gizmo/projection.hpp"
#include "views.hpp"

namespace lambent::editor {
namespace {

using testing::kViewport;
constexpr float kAspect = 800.0f / 600.0f;
const scene::Box kBounds{glm::vec3(-1.0f, 0.0f, -2.0f), glm::vec3(3.0f, 2.0f, 2.0f)};

CameraPose tilted(bool orthographic = false) {
  CameraPose pose;
  pose.target_ws = {0.5f, 1.0f, -0.25f};
  pose.azimuth_deg = 40.0f;
  pose.elevation_deg = 25.0f;
  pose.distance_m = 6.0f;
  pose.orthographic = orthographic;
  return pose;
}
glm::dvec2 seen(const CameraPose& pose, glm::vec3 point) {
  return *Projection(viewOf(pose, kBounds, kAspect), kViewport).toScreen(glm::dvec3(point));
}

TEST(CameraControl, PanKeepsTheTargetsPlaneUnderThePointer) {
  for (const bool orthographic : {false, true}) {
    const CameraPose pose = tilted(orthographic);
    CameraInput input;
    input.height_px = kViewport.height;
    input.pan_px = {53.0f, -21.0f};
    const CameraPose next = moved(pose, input, kBounds);
    EXPECT_LT(glm::length(seen(next, pose.target_ws) - seen(pose, pose.target_ws) - glm::dvec2(53.0, -21.0)),
              0.01);
  }
}

TEST(CameraControl, OrbitKeepsTheTargetLookKeepsTheEye) {
  const CameraPose pose = tilted();
  CameraInput input;
  input.height_px = kViewport.height;
  input.orbit_px = {100.0f, 30.0f};
  const CameraPose around = moved(pose, input, kBounds);
  EXPECT_EQ(around.target_ws, pose.target_ws);
  EXPECT_FLOAT_EQ(around.azimuth_deg, 10.0f) << "100 of 600 pixels: 30 degrees";
  EXPECT_FLOAT_EQ(around.elevation_deg, 34.0f);
  input = {};
  input.height_px = kViewport.height;
  input.look_px = {10.0f, 0.0f};
  const CameraPose looked = moved(pose, input, kBounds);
  EXPECT_LT(glm::length(looked.eye() - pose.eye()), 1e-5f);
  EXPECT_LT(seen(looked, pose.target_ws).x, seen(pose, pose.target_ws).x) << "to the right: it goes left";
  input.look_px = {};
  input.orbit_px = {0.0f, 9000.0f};
  EXPECT_EQ(moved(pose, input, kBounds).elevation_deg, 90.0f) << "not over the top";
}

TEST(CameraControl, FlyingIsInSizesOfTheSceneAndTheSameInManySteps) {
  CameraInput input;
  input.fly = {0.0f, 0.0f, 1.0f};
  input.seconds = 1.0f;
  const CameraPose pose = tilted(), far = moved(pose, input, kBounds);
  CameraPose steps = pose;
  input.seconds = 0.01f;
  for (int i = 0; i < 100; ++i) steps = moved(steps, input, kBounds);
  EXPECT_LT(glm::length(steps.target_ws - far.target_ws), 1e-4f);
  const float way = glm::dot(far.eye() - pose.eye(), glm::normalize(pose.target_ws - pose.eye()));
  EXPECT_NEAR(way, 0.7f * kBounds.radius(), 1e-4f);
}

TEST(CameraControl, WhatIsFramedFillsThePictureAndStaysInIt) {
  const scene::Box tall{glm::vec3(4.0f, -1.0f, 2.0f), glm::vec3(4.5f, 7.0f, 2.25f)};
  const scene::Box flat{glm::vec3(-30.0f, 0.0f, -2.0f), glm::vec3(30.0f, 0.0f, 2.0f)};
  for (const bool orthographic : {false, true}) {
    for (const scene::Box& box : {tall, flat, kBounds}) {
      const CameraPose pose = framed(tilted(orthographic), box, kAspect);
      const Projection projection(viewOf(pose, box, kAspect), kViewport);
      double reach = 0.0;
      for (int corner = 0; corner < 8; ++corner) {
        const glm::dvec3 point(corner & 1 ? box.max.x : box.min.x, corner & 2 ? box.max.y : box.min.y,
                               corner & 4 ? box.max.z : box.min.z);
        const auto pixel = projection.toScreen(point);
        ASSERT_TRUE(pixel);
        reach = std::max(
            {reach, std::abs((pixel->x - 40.0) / 400.0 - 1.0), std::abs((pixel->y - 20.0) / 300.0 - 1.0)});
      }
      EXPECT_NEAR(reach, 0.9, 1e-3) << orthographic;
    }
  }
  const scene::Box point{glm::vec3(1.0f), glm::vec3(1.0f)};
  EXPECT_EQ(framed(tilted(), point, kAspect).distance_m, tilted().distance_m);
  EXPECT_EQ(framed(tilted(), point, kAspect).target_ws, glm::vec3(1.0f));
}

TEST(CameraControl, OrbitsGiveTheVeryPictureAndPosesComeBackExactly) {
  const spec::OrbitCamera orbit{-130.0f, 90.0f, 2.5f, 35.0f};  // straight down
  const CameraPose pose = fromOrbit(orbit, kBounds);
  const spec::View ours = viewOf(pose, kBounds, kAspect),
                   theirs = spec::orbitView(orbit, kBounds.min, kBounds.max, kAspect);
  for (int column = 0; column < 4; ++column) {
    EXPECT_LT(glm::length(ours.view_from_world[column] - theirs.view_from_world[column]), 1e-4f);
    EXPECT_LT(glm::length(ours.clip_from_view[column] - theirs.clip_from_view[column]), 1e-3f);
  }
  for (const bool orthographic : {false, true})
    EXPECT_EQ(*parsePose(poseWord(tilted(orthographic))), tilted(orthographic));
  EXPECT_FALSE(parsePose("pose:1,2,3"));
  EXPECT_FALSE(parsePose("pose:0,0,0,0,0,-1,40"));
  EXPECT_FALSE(parsePose("pose:0,0,0,0,0,nan,40"));
}

TEST(CameraControl, ACameraOfAFileIsTakenOverWhereItStands) {
  for (const float elevation : {-90.0f, -40.0f, 0.0f, 90.0f}) {
    for (const bool orthographic : {false, true}) {
      CameraPose pose = tilted(orthographic);
      pose.elevation_deg = elevation;
      scene::CameraComponent camera;
      camera.perspective = !orthographic;
      camera.yfov_rad = glm::radians(pose.fov_deg);
      camera.ymag = pose.halfHeight();
      const CameraPose taken = fromNode(nodeMatrix(pose), camera, kBounds);
      EXPECT_LT(glm::length(taken.eye() - pose.eye()), 1e-4f);
      EXPECT_NEAR(taken.azimuth_deg, pose.azimuth_deg, 0.01f) << elevation;
      EXPECT_NEAR(taken.elevation_deg, elevation, 0.05f);
      if (orthographic)
        EXPECT_NEAR(taken.halfHeight(), pose.halfHeight(), 1e-4f);
      else
        EXPECT_NEAR(taken.fov_deg, pose.fov_deg, 1e-3f);
    }
  }
}

TEST(CameraControl, EasingGoesTheShorterWayAndArrives) {
  CameraPose pose = tilted(), goal = tilted();
  pose.azimuth_deg = 170.0f;
  goal.azimuth_deg = -170.0f;
  goal.distance_m = 60.0f;
  const CameraPose half = eased(pose, goal, 0.06f, 0.06f);
  EXPECT_NEAR(std::abs(half.azimuth_deg), 180.0f, 1e-3f);
  EXPECT_NEAR(half.distance_m, std::sqrt(360.0f), 1e-3f) << "by factors, not by metres";
  const CameraPose once = eased(pose, goal, 0.1f);
  CameraPose steps = pose;
  for (int i = 0; i < 10; ++i) steps = eased(steps, goal, 0.01f);
  EXPECT_NEAR(steps.distance_m, once.distance_m, 1e-3f) << "whatever the frame rate";
  for (int i = 0; i < 100 && !(pose == goal); ++i) pose = eased(pose, goal, 0.02f);
  EXPECT_EQ(pose, goal);
}

}  // namespace
}  // namespace lambent::editor
