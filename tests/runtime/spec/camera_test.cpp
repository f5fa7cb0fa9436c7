// Tests where the cameras are, what they see, and that their depth range contains the scene.
#include "runtime/spec/camera.hpp"

#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

namespace lambent::spec {
namespace {

constexpr glm::vec3 kMin(-1, 0, -2), kMax(3, 4, 2);  // centre (1, 2, 0), radius sqrt(12)
const float kRadius = std::sqrt(12.0f);

glm::vec3 toNdc(const View& view, glm::vec3 point) {
  const glm::vec4 clip = view.clip_from_view * view.view_from_world * glm::vec4(point, 1.0f);
  return glm::vec3(clip) / clip.w;
}

TEST(SpecCamera, ParsesOrbitAndNames) {
  const OrbitCamera orbit = std::get<OrbitCamera>(parseCamera("orbit:-30,12.5,2,45").value());
  EXPECT_EQ(orbit.azimuth_deg, -30.0f);
  EXPECT_EQ(orbit.elevation_deg, 12.5f);
  EXPECT_EQ(orbit.distance_radii, 2.0f);
  EXPECT_EQ(orbit.fov_deg, 45.0f);
  EXPECT_EQ(std::get<NamedCamera>(parseCamera("main").value()).name_or_index, "main");
  for (const char* wrong :
       {"", "orbit:", "orbit:1,2,3", "orbit:1,2,3,4,5", "orbit:0,95,2,40", "orbit:0,0,0,40",
        "orbit:0,0,-1,40", "orbit:0,0,2,0", "orbit:0,0,2,180", "orbit:0,0,2,40deg"})
    EXPECT_FALSE(parseCamera(wrong)) << wrong;
}

TEST(SpecCamera, OrbitStandsWhereItsAnglesSay) {
  const glm::vec3 centre(1, 2, 0);
  const View front = orbitView({0, 0, 3, 40}, kMin, kMax, 1.5f);
  EXPECT_LT(glm::length(front.eye_ws - (centre + glm::vec3(0, 0, 3 * kRadius))), 1e-5f);
  const View right = orbitView({90, 0, 3, 40}, kMin, kMax, 1.5f);
  EXPECT_LT(glm::length(right.eye_ws - (centre + glm::vec3(3 * kRadius, 0, 0))), 1e-5f);
  // From the front +X is on the right and +Y up; from above (no special case) +X still is.
  EXPECT_GT(toNdc(front, centre + glm::vec3(0.1f, 0, 0)).x, 0.0f);
  EXPECT_GT(toNdc(front, centre + glm::vec3(0, 0.1f, 0)).y, 0.0f);
  const View above = orbitView({0, 90, 3, 40}, kMin, kMax, 1.5f);
  EXPECT_GT(toNdc(above, centre + glm::vec3(0.1f, 0, 0)).x, 0.0f);
  EXPECT_GT(toNdc(above, centre - glm::vec3(0, 0, 0.1f)).y, 0.0f);
}

TEST(SpecCamera, DepthHoldsTheBoundsFromOutsideAndInside) {
  for (const float distance : {0.1f, 0.9f, 1.1f, 3.0f, 100.0f}) {
    const View view = orbitView({33, 21, distance, 40}, kMin, kMax, 1.5f);
    for (int corner = 0; corner < 8; ++corner) {
      const glm::vec3 point((corner & 1) ? kMax.x : kMin.x, (corner & 2) ? kMax.y : kMin.y,
                            (corner & 4) ? kMax.z : kMin.z);
      const glm::vec4 clip = view.clip_from_view * view.view_from_world * glm::vec4(point, 1.0f);
      if (clip.w > 0.01f * kRadius) {
        EXPECT_LE(std::abs(clip.z), clip.w) << distance;
      }
    }
  }
}

TEST(SpecCamera, AFlatOrEmptySceneStillGivesFiniteMatrices) {
  const View view = orbitView({}, glm::vec3(2), glm::vec3(2), 1.0f);
  for (int column = 0; column < 4; ++column)
    for (int row = 0; row < 4; ++row) {
      EXPECT_TRUE(std::isfinite(view.clip_from_view[column][row]));
      EXPECT_TRUE(std::isfinite(view.view_from_world[column][row]));
    }
}

TEST(SpecCamera, FileCamerasLookAlongMinusZWhateverTheScale) {
  const gltf::Camera camera{.name = "main", .yfov_rad = 0.7f};
  const glm::mat4 node =
      glm::scale(glm::translate(glm::mat4(1.0f), glm::vec3(0, 1, 9)), glm::vec3(2, 3, 0.5f));
  const Result<View> view = cameraView(camera, node, kMin, kMax, 1.0f);
  ASSERT_TRUE(view) << view.error().line();
  EXPECT_EQ(view->eye_ws, glm::vec3(0, 1, 9));
  EXPECT_NEAR(toNdc(*view, glm::vec3(0, 1 + 9 * std::tan(0.35f), 0)).y, 1.0f, 1e-5f);
  EXPECT_FALSE(cameraView(camera, glm::scale(glm::mat4(1.0f), glm::vec3(0)), kMin, kMax, 1.0f));
  EXPECT_FALSE(cameraView({.name = "wide", .yfov_rad = 4.0f}, node, kMin, kMax, 1.0f));
}

TEST(SpecCamera, OrthographicCamerasShowTwiceYmag) {
  const gltf::Camera camera{.name = "plan", .perspective = false, .ymag = 2.5f};
  const Result<View> view =
      cameraView(camera, glm::translate(glm::mat4(1.0f), glm::vec3(0, 0, 9)), kMin, kMax, 2.0f);
  ASSERT_TRUE(view) << view.error().line();
  EXPECT_NEAR(toNdc(*view, glm::vec3(5, 2.5f, 1)).x, 1.0f, 1e-6f);
  EXPECT_NEAR(toNdc(*view, glm::vec3(5, 2.5f, 1)).y, 1.0f, 1e-6f);
}

TEST(SpecCamera, AreFoundByNameNodeNameAndIndexOrListed) {
  std::vector<gltf::Node> nodes(4);
  nodes[1].camera = 1;
  nodes[2].camera = 0;
  nodes[2].name = "tripod";
  nodes[3].name = "second";  // no camera: its name must not match
  const std::vector<gltf::Camera> cameras = {{.name = ""}, {.name = "second"}};
  EXPECT_EQ(findCameraNode(nodes, cameras, {"second"}).value(), 1u);
  EXPECT_EQ(findCameraNode(nodes, cameras, {"tripod"}).value(), 2u);
  EXPECT_EQ(findCameraNode(nodes, cameras, {"1"}).value(), 1u);
  const auto missing = findCameraNode(nodes, cameras, {"third"});
  ASSERT_FALSE(missing);
  EXPECT_NE(missing.error().line().find("0, 1 (second)"), std::string::npos) << missing.error().line();
  EXPECT_FALSE(findCameraNode(nodes, {}, {"0"}));
}

}  // namespace
}  // namespace lambent::spec
