// Compares sphere and disc lights, which light words add to a scene, with closed forms; and tests the scene
// at a given time.
#include <gtest/gtest.h>

#include "reference/lights.hpp"
#include "reference/reference.hpp"
#include "tests/reference/measure.hpp"

namespace lambent::baker::reference {
namespace {

using testing::expectMean;
using testing::measured;
using testing::samples;
using testing::sceneOf;

// Rays start above the floor by 2^-19 of its 20 m, and are nearer to the light by as much.
constexpr double kOffset = 2e-4;

spec::Light sphere(glm::vec3 place, float radius, float radiance) {
  return spec::SphereLight{.position_ws = place, .radius_m = radius, .radiance = glm::vec3(radiance)};
}
spec::Light disc(glm::vec3 place, glm::vec3 normal, float radius, float radiance) {
  return spec::DiscLight{.position_ws = place,
                         .normal_ws = glm::normalize(normal),
                         .radius_m = radius,
                         .radiance = glm::vec3(radiance)};
}
Scene whiteFloor() {
  return sceneOf({testing::grid({0, 0, 0}, 20.0f, 1)});
}

// Returns E/pi of a sphere entirely above the horizon: L r²/d² cos.
TEST(SphereLight, LightsAFloorAsAPointOfItsPowerWould) {
  for (const float x : {0.0f, 0.8f, 3.0f})
    for (const float radius : {0.001f, 0.3f, 0.999f}) {
      const double d2 = 1.0 + double{x} * double{x};
      const double expected = 10.0 * double{radius} * double{radius} / d2 / std::sqrt(d2);
      const auto floor = measured(whiteFloor(), {x, 0.9f, 3.0f}, {x, 0, 0},
                                  {sphere({0, 1, 0}, radius, 10.0f)}, samples(64, 0));
      expectMean(floor, expected, kOffset * expected);
      EXPECT_LT(floor.error.g, 0.005 * expected) << x << " " << radius;
    }
}

TEST(SphereLight, IsNotSeenAndStandsInNobodysWay) {
  const auto light = sphere({0, 1, 0}, 0.5f, 10.0f);
  const auto sky = measured(whiteFloor(), {0, 1, 4}, {0, 1, 0}, {light}, samples(4));
  EXPECT_EQ(sky.mean.g, 0.0);
  EXPECT_EQ(sky.alpha, 0.0);
  // The light of another sphere passes through this one unchanged: 10 * 0.1² / 3² more.
  const auto both = measured(whiteFloor(), {0, 0.2f, 4}, {0, 0, 0}, {light, sphere({0, 3, 0}, 0.1f, 10.0f)},
                             samples(64, 0));
  expectMean(both, 10.0 * 0.25 + 10.0 * 0.01 / 9.0);
}

TEST(SphereLight, FromInsideComesFromEverywhereThatNothingBlocks) {
  Scene scene = whiteFloor();
  const auto around = sphere({1, -2, 0.5f}, 50.0f, 3.0f);
  expectMean(measured(scene, {0, 1, 3}, {0, 0, 0}, {around}, samples(16, 0)), 3.0);
  // A half plane that is upright on the floor hides half of it.
  scene = sceneOf({testing::grid({0, 0, 0}, 20.0f, 1),
                   testing::turned(testing::grid({0, 0, 0}, 4000.0f, 1), -90.0f, {0, 0, 1})});
  gltf::Material black = testing::matte(0.0f);
  black.double_sided = true;
  testing::paint(scene, 1, black);
  expectMean(measured(scene, {3, 1, 0}, {1e-3f, 0, 0}, {sphere({0, 0, 0}, 1000.0f, 3.0f)}, samples(64, 0)),
             1.5, 2e-3);
}

// Returns E/pi on the axis: L r²/(r² + h²).
TEST(DiscLight, LightsWhatLiesOnItsAxisInClosedForm) {
  for (const float height : {0.002f, 0.5f, 2.0f, 30.0f}) {
    const double expected = 7.0 / (1.0 + double{height} * double{height});
    // The camera is between disc and floor.
    const auto floor = measured(whiteFloor(), {0, 0.9f, 3}, {0, 0, 0},
                                {disc({0, height, 0}, {0, -1, 0}, 1.0f, 7.0f)}, samples(128, 0));
    expectMean(floor, expected, 1e-4 * expected);
    EXPECT_LT(floor.error.g, 0.01 * expected) << height;
  }
}

TEST(DiscLight, ShinesToOneSideAndNotAlongItsPlane) {
  const auto floor = [&](const spec::Light& light) {
    return measured(whiteFloor(), {0, 0.9f, 3}, {0, 0, 0}, {light}, samples(64, 0)).mean.g;
  };
  EXPECT_EQ(floor(disc({0, 1, 0}, {0, 1, 0}, 1.0f, 7.0f)), 0.0);
  EXPECT_EQ(floor(disc({0, -1, 0}, {0, 1, 0}, 1.0f, 7.0f)), 0.0) << "under the floor";
  EXPECT_EQ(floor(disc({3, 0, 0}, {0, -1, 0}, 1.0f, 7.0f)), 0.0) << "in the plane of the floor";
  EXPECT_EQ(floor(disc({0, 1, 0}, {0, -1, 0}, 0.0f, 7.0f)), 0.0) << "radius 0";
  EXPECT_EQ(floor(sphere({0, 1, 0}, 0.0f, 7.0f)), 0.0);
}

TEST(ShapeLights, HardPlacesStayFinite) {
  for (const glm::vec3 place :
       {glm::vec3(0), glm::vec3(0, 1e-6f, 0), glm::vec3(1, 0, 0), glm::vec3(0, 1e30f, 0)})
    for (const float radius : {1e-30f, 1e-6f, 1.0f, 1e18f}) {
      const auto report =
          measured(whiteFloor(), {0, 0.9f, 3}, {0, 0, 0},
                   {sphere(place, radius, 1e8f), disc(place, {0, -1, 0}, radius, 1e8f)}, samples(16, 1));
      EXPECT_TRUE(std::isfinite(report.mean.g)) << place.y << " " << radius;
      // Two lights around a white floor give no more than this, in the mean over everything but noise.
      EXPECT_LE(report.mean.g, 2.1e8) << place.y << " " << radius;
    }
}

TEST(Time, PutsTheSceneWhereItsAnimationsHaveIt) {
  // A ceiling reveals the sky after half a second.
  Scene scene =
      sceneOf({testing::grid({0, 0, 0}, 8.0f, 1), testing::flipped(testing::grid({0, 0, 0}, 8.0f, 1))});
  gltf::Node& ceiling = scene.nodes[1];
  ceiling.animated = true;
  ceiling.trs = gltf::Trs{.translation = {0, 1, 0}};
  ceiling.parent_from_node = ceiling.trs->matrix();
  scene.animations = {{.name = "away",
                       .channels = {{.node = 1,
                                     .path = gltf::AnimationChannel::Path::Translation,
                                     .interpolation = gltf::AnimationChannel::Interpolation::Linear,
                                     .times_s = {0, 1},
                                     .values = {0, 1, 0, 8, 1, 0}}}}};
  const std::vector<spec::Light> zenith = {sphere({0, 100, 0}, 10.0f, 100.0f)};
  const auto at = [&](float time) {
    Scene posed = scene;
    poseAt(posed, time);
    EXPECT_TRUE(posed.warnings.empty());
    return measured(posed, {0, 0.3f, 2}, {0, 0, 0}, zenith, samples(64, 0)).mean.g;
  };
  EXPECT_EQ(at(0.0f), 0.0);
  EXPECT_EQ(at(0.25f), 0.0);
  EXPECT_NEAR(at(0.75f), 1.0, 0.01);
  EXPECT_NEAR(at(9.0f), 1.0, 0.01);
  Scene still = whiteFloor();
  poseAt(still, 1.0f);
  EXPECT_EQ(still.warnings.size(), 1u);

  // A checkpoint of another time or another light belongs to another picture.
  const auto digest = [&](float time, const std::vector<spec::LocalLight>& shapes) {
    Scene posed = scene;
    poseAt(posed, time);
    return digestOf(posed, {}, shapes, {}, {});
  };
  const std::vector<spec::LocalLight> one = {spec::SphereLight{.radius_m = 1}},
                                      other = {spec::SphereLight{.radius_m = 2}},
                                      plate = {spec::DiscLight{.radius_m = 1}};
  EXPECT_EQ(digest(0.5f, one), digest(0.5f, one));
  EXPECT_NE(digest(0.5f, one), digest(0.25f, one));
  EXPECT_NE(digest(0.5f, one), digest(0.5f, other));
  EXPECT_NE(digest(0.5f, one), digest(0.5f, plate));
  EXPECT_NE(digest(0.5f, one), digest(0.5f, {}));
}

}  // namespace
}  // namespace lambent::baker::reference
