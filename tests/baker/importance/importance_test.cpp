// Tests that importance is what pictures show: it follows eyes, sums to one, and leaves out what nobody sees.
#include "baker/importance/importance.hpp"

#include <cmath>
#include <vector>

#include <gtest/gtest.h>

#include "baker/transport/samples.hpp"
#include "tests/support/shapes.hpp"
#include "tests/support/transport.hpp"

namespace lambent::baker {
namespace {

using testing::box;
using testing::flipped;
using testing::grid;
using testing::sceneOf;
using testing::Transport;

// Makes a room of 4 x 3 x 4 m with walls of 0.2 m and outside faces.
Scene houseWithOutsideFaces() {
  return sceneOf({flipped(box({0, 0, 0}, {4.0f, 3.0f, 4.0f}, 4)), box({0, 0, 0}, {4.4f, 3.4f, 4.4f}, 4)});
}

Importance importanceOf(const Transport& t) {
  return {t.geometry, t.rays, cameraEyes(t.scene, findRigidGroups(t.scene).at(0), t.geometry)};
}

Scene withCamera(Scene scene, const glm::vec3& at) {
  scene.cameras.push_back({.name = "main", .yfov_rad = 1.0f, .aspect = 1.0f});
  gltf::Node node;
  node.camera = 0;
  node.parent_from_node = glm::translate(glm::mat4(1.0f), at);
  scene.roots.push_back(static_cast<std::int32_t>(scene.nodes.size()));
  scene.nodes.push_back(node);
  return scene;
}

// Returns the integral of what is seen over all triangles, and of the part for which `counts` holds.
template <typename Counts>
std::pair<double, double> seenIn(const Transport& t, const Importance& importance, const Counts& counts) {
  double all = 0.0, part = 0.0;
  for (const glm::uvec3& corners : t.geometry.triangles) {
    const glm::vec3 normal = glm::normalize(areaNormal(t.geometry, corners)),
                    middle = (t.geometry.positions[corners.x] + t.geometry.positions[corners.y] +
                              t.geometry.positions[corners.z]) /
                             3.0f;
    const double seen =
        triangleArea(t.geometry, corners) * double{importance.at({middle + 1e-3f * normal, normal}).seen};
    all += seen;
    if (counts(middle)) part += seen;
  }
  return {all, part};
}

TEST(Importance, OutsideFacesHaveNoneForACameraInAClosedRoom) {
  const Transport t(withCamera(houseWithOutsideFaces(), {0.5f, 0.0f, 1.0f}));
  const Importance importance = importanceOf(t);
  const auto outside = [](const glm::vec3& p) {
    return std::abs(p.x) > 2.1f || std::abs(p.y) > 1.6f || std::abs(p.z) > 2.1f;
  };
  const auto [all, there] = seenIn(t, importance, outside);
  EXPECT_GT(all, 0.5);
  EXPECT_EQ(there, 0.0);
  for (const SeenPoint& point : importance.look(2048, t.geometry, t.rays))
    EXPECT_FALSE(outside(point.position));
}

TEST(Importance, WhatIsSeenSumsToAllPictures) {
  const Transport t(sceneOf({flipped(box({0, 0, 0}, {4.0f, 3.0f, 4.0f}, 24))}));
  const Importance importance = importanceOf(t);
  const auto [all, ignored] = seenIn(t, importance, [](const glm::vec3&) { return true; });
  EXPECT_NEAR(all, 1.0, 0.1) << "eyes that are very near a wall count a little less";
  double shares = 0.0;
  for (const SeenPoint& point : importance.look(2048, t.geometry, t.rays)) shares += double{point.share};
  EXPECT_NEAR(shares, 1.0, 1e-4);
}

TEST(Importance, ACubeOnAWideGroundTakesUpAGoodPartOfPictures) {
  const Transport t(sceneOf({grid({0, 0, 0}, 200.0f, 1), box({0, 0.5f, 0}, glm::vec3(1.0f), 2)}));
  const Importance importance = importanceOf(t);
  double cube = 0.0, near = 0.0;
  for (const SeenPoint& point : importance.look(4096, t.geometry, t.rays)) {
    if (point.position.y > 0.01f) cube += double{point.share};
    if (glm::length(point.position) < 3.0f) near += double{point.share};
  }
  EXPECT_GT(cube, 0.05) << "it has 6 m^2 of 40,000";
  EXPECT_GT(near, 0.15);
}

TEST(Importance, EyesLookAtABodyFromAllAround) {
  const Transport t(sceneOf({testing::icosphere(glm::vec3(0.0f), 1.0f, 3)}));
  float least = 1.0f, most = -1.0f;
  for (const SeenPoint& point : importanceOf(t).look(1536, t.geometry, t.rays)) {
    EXPECT_GT(glm::dot(point.to_eye, point.position), -0.1f) << "eyes are outside";
    least = std::min(least, point.position.y), most = std::max(most, point.position.y);
  }
  EXPECT_LT(least, -0.8f);
  EXPECT_GT(most, 0.8f);
}

TEST(Importance, ACameraHasHalfOfAllPicturesInItsFrustum) {
  const Transport t(withCamera(sceneOf({flipped(box({0, 0, 0}, {4.0f, 3.0f, 4.0f}, 8))}), {0, 0, 1.5f}));
  double of_camera = 0.0, ahead = 0.0;
  const Importance importance = importanceOf(t);
  for (const SeenPoint& point : importance.look(4096, t.geometry, t.rays)) {
    if (importance.eyes()[point.eye].view != Eye::View::Frustum) continue;
    of_camera += double{point.share};
    if (point.position.z < 1.5f) ahead += double{point.share};
  }
  EXPECT_NEAR(of_camera, 0.5, 0.01);
  EXPECT_NEAR(ahead, of_camera, 1e-6) << "it looks along -z";
}

TEST(Importance, SurfacesThatLightWhatIsSeenMatterThoughNobodySeesThem) {
  // The camera looks at the back wall only; the walls beside it send light there.
  Scene scene = withCamera(sceneOf({flipped(box({0, 0, 0}, {4.0f, 3.0f, 4.0f}, 8))}), {0, 0, 1.9f});
  scene.cameras[0].yfov_rad = 0.3f;
  const Transport t(scene);
  const Importance importance = importanceOf(t);
  EXPECT_GT(importance.at({{1.99f, 0.0f, -1.5f}, {-1, 0, 0}}).sent, 0.0f);
}

TEST(Regions, HaveAsMuchOfThePicturesEach) {
  std::vector<glm::vec3> points;
  for (std::size_t i = 1; i <= 4096; ++i)
    points.emplace_back(std::pow(10.0f, 4.0f * radicalInverse(i, 2)), radicalInverse(i, 3), 0.0f);
  const Regions regions(points, 6);
  std::vector<int> counts(regions.size(), 0);
  for (const glm::vec3& point : points) ++counts[regions.at(point)];
  for (const int count : counts) EXPECT_EQ(count, 64);
}

TEST(Regions, BoundAllButTheWorstTwentiethOfErrors) {
  std::vector<double> errors(20, 0.01), weights(20, 1.0);
  errors[3] = 9.0;
  EXPECT_EQ(boundingError(errors, weights), 0.01);
  errors[7] = 0.5;
  EXPECT_EQ(boundingError(errors, weights), 0.5);
  weights[3] = 0.0;
  EXPECT_EQ(boundingError(errors, weights), 0.5) << "what is not seen has no error";
}

}  // namespace
}  // namespace lambent::baker
