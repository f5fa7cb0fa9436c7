// Tests a group's own lights whose direct light goes per pixel: sharp shadows as in closed forms, bounced
// light as in the path-traced reference, and every path once.
#include <cmath>

#include <glm/geometric.hpp>
#include <glm/gtc/constants.hpp>

#include "tests/stability/show.hpp"
#include "tests/support/differences.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using testing::add;
using testing::named;
using testing::Show;
using ColumnLight = testing::GpuTest;

constexpr float kGrey = 0.6f, kRadiance = 400.0f, kRadius = 0.05f, kBulbHeight = 1.0f;
const glm::vec3 kEye(0.9f, 0.6f, 0.9f);

// Has a bulb 1 m above a floor, and a plate of 0.2 m halfway below it. All of it is one rigid group, unless
// the plate is movable.
assets::Scene lampScene(bool closed, bool movable = false) {
  assets::Scene scene = named("lamp");
  add(scene, "floor", assets::plane({-1, 0, 1}, {2, 0, 0}, {0, 0, -2}, 0.1f), glm::vec3(kGrey), {0, 0, 0},
      false);
  add(scene, "plate", assets::box({-0.1f, 0.49f, -0.1f}, {0.1f, 0.5f, 0.1f}, 0.1f), glm::vec3(kGrey),
      {0, 0, 0}, movable);
  add(scene, "bulb", assets::sphere(kRadius, 8), glm::vec3(kGrey), {0, kBulbHeight, 0}, false,
      glm::vec3(kRadiance));
  if (!closed) return scene;
  const auto wall = [&](const char* name, glm::vec3 corner, glm::vec3 right, glm::vec3 up) {
    add(scene, name, assets::plane(corner, right, up, 0.1f), glm::vec3(kGrey), {0, 0, 0}, false);
  };
  wall("ceiling", {-1, 2, -1}, {2, 0, 0}, {0, 0, 2});
  wall("back", {-1, 0, -1}, {2, 0, 0}, {0, 2, 0});
  wall("front", {1, 0, 1}, {-2, 0, 0}, {0, 2, 0});
  wall("left", {-1, 0, 1}, {0, 0, -2}, {0, 2, 0});
  wall("right", {1, 0, -1}, {0, 0, 2}, {0, 2, 0});
  return scene;
}

constexpr float kIntensity = 3.0f;

// Has a spot in the place of the bulb.
assets::Scene spotScene(bool movable) {
  assets::Scene scene = lampScene(false, movable);
  scene.nodes.pop_back();
  scene.meshes.pop_back();
  scene.materials.pop_back();
  scene.spots = {
      {.name = "spot", .intensity_cd = kIntensity, .inner_cone_deg = 60.0f, .outer_cone_deg = 80.0f}};
  assets::Node node{.name = "lamp", .mesh = -1, .translation = {0, kBulbHeight, 0}};
  node.rotation = glm::angleAxis(glm::radians(-90.0f), glm::vec3(1, 0, 0));  // from -Z to -Y
  node.spot = 0;
  scene.nodes.push_back(node);
  return scene;
}

// Returns the floor's radiance on the x axis where nothing hides the spot.
float underSpot(float x) {
  const float squared = kBulbHeight * kBulbHeight + x * x;
  return kGrey / glm::pi<float>() * kIntensity * kBulbHeight / (squared * std::sqrt(squared));
}

// Returns the floor's radiance where nothing hides the bulb: the whole sphere is above the horizon.
float openAt(const glm::vec3& place) {
  const glm::vec3 way = glm::vec3(0, kBulbHeight, 0) - place;
  const float squared = glm::dot(way, way);
  return kGrey * kRadiance * (kRadius * kRadius / squared) * way.y / std::sqrt(squared);
}

std::vector<spec::Light> noLight() {
  return {testing::constantLight(0.0f)};
}

void setLocalShadows(Show& show, bool on) {
  frame::FrameSettings settings = show.frame->settings();
  settings.local_shadows = on;
  ASSERT_TRUE(show.frame->setSettings(settings));
}

}  // namespace

TEST_F(ColumnLight, ABulbCastsTheSharpShadowOfAPlate) {
  Show show(lampScene(false), noLight(), 0, /*bounces=*/0);
  // The umbra reaches 0.15 m, the penumbra from there to 0.25 m.
  for (const float x : {0.0f, 0.08f, 0.13f})
    EXPECT_LT(show.patch(kEye, {x, 0, 0}).g, 0.01f * openAt({x, 0, 0})) << x;
  for (const float x : {0.28f, 0.35f, 0.5f, 0.8f}) {
    const glm::vec3 place(x, 0, 0.02f);
    EXPECT_NEAR(show.patch(kEye, place).g / openAt(place), 1.0f, 0.02f) << x;
  }
  EXPECT_EQ(show.frame->counts()["shadowed_lights"], 1u);
  // The bulb shows its emission alone, because its own light does not reach it.
  EXPECT_NEAR(show.patch(kEye, {0.0f, kBulbHeight, 0.0f}).g / kRadiance, 1.0f, 0.001f);
}

TEST_F(ColumnLight, ASpotOfTheGroupCastsTheSharpShadowOfAPlate) {
  Show show(spotScene(/*movable=*/false), noLight(), 0, /*bounces=*/0);
  // The plate's upper side, half way down, shades the floor to 0.2 m.
  for (const float x : {0.0f, 0.08f, 0.15f}) EXPECT_LT(show.patch(kEye, {x, 0, 0}).g, 1e-4f) << x;
  for (const float x : {0.25f, 0.3f, 0.6f, 0.9f})
    EXPECT_NEAR(show.patch(kEye, {x, 0, 0}).g / underSpot(x), 1.0f, 0.02f) << x;
  EXPECT_EQ(show.frame->counts()["shadowed_lights"], 1u);
}

TEST_F(ColumnLight, ABodyThatHasTheLampByACubeTooKeepsItsGrid) {
  Show show(spotScene(/*movable=*/true), noLight(), 0, /*bounces=*/0);
  for (const float x : {0.0f, 0.15f}) EXPECT_LT(show.patch(kEye, {x, 0, 0}).g, 0.01f * underSpot(x)) << x;
  // The plate's own light arrives in five bands.
  for (const float x : {0.25f, 0.3f, 0.6f})
    EXPECT_NEAR(show.patch(kEye, {x, 0, 0}).g / underSpot(x), 1.0f, 0.05f) << x;
  EXPECT_EQ(show.frame->counts()["shadowed_lights"], 2u) << "one for the floor, one for the plate";
  EXPECT_EQ(show.frame->counts()["neighborhood_pairs"], 1u);
}

TEST_F(ColumnLight, WithoutShadowCubesAllOfItGoesByTheColumn) {
  Show show(lampScene(false), noLight(), 0, /*bounces=*/0);
  setLocalShadows(show, false);
  float worst = 0.0f;
  for (const float x : {0.45f, 0.6f, 0.8f}) {
    const glm::vec3 place(x, 0, 0.1f);
    const float column = show.patch(kEye, place).g;
    EXPECT_NEAR(column / openAt(place), 1.0f, 0.06f) << "the column at vertices, " << x;
    worst = testing::larger(worst, std::abs(column - openAt(place)));
  }
  EXPECT_EQ(show.frame->counts()["shadowed_lights"], 0u);
  EXPECT_GT(worst, 0.0f);
  setLocalShadows(show, true);
  EXPECT_NEAR(show.patch(kEye, {0.6f, 0, 0.1f}).g / openAt({0.6f, 0, 0.1f}), 1.0f, 0.02f);
  show.world.scaleLamps(0.5f);
  EXPECT_NEAR(show.patch(kEye, {0.6f, 0, 0.1f}).g / openAt({0.6f, 0, 0.1f}), 0.5f, 0.01f);
}

TEST_F(ColumnLight, ABodyShadesItOnceByTheCubeAndNotByItsGrid) {
  Show show(lampScene(false, /*movable=*/true), noLight(), 0, /*bounces=*/0);
  const auto at = [&](float x) { return show.patch(kEye, {x, 0, 0.02f}).g / openAt({x, 0, 0.02f}); };
  for (const float x : {0.0f, 0.13f}) EXPECT_LT(at(x), 0.01f) << x;
  // Light of the bright plate arrives in five bands, which take up to 3.4 % away here.
  for (const float x : {0.28f, 0.35f, 0.6f})
    EXPECT_NEAR(at(x), 1.0f, 0.05f) << "nothing is taken twice, " << x;
  EXPECT_EQ(show.frame->counts()["shadowed_lights"], 1u);
  EXPECT_EQ(show.frame->counts()["neighborhood_pairs"], 0u);
  setLocalShadows(show, false);
  EXPECT_LT(at(0.0f), 0.2f) << "the column has the body's shadow from its grid";
  EXPECT_EQ(show.frame->counts()["neighborhood_pairs"], 1u);
}

TEST_F(ColumnLight, BouncesAsInTheReference) {
  Show show(lampScene(true), noLight());
  double found = 0.0, by_column = 0.0, expected = 0.0;
  const auto referenceAt = [&](const glm::vec3& target) {
    return show.referenceAt(kEye, target, noLight(), 256);
  };
  // The first places see only bounced light.
  for (const glm::vec3& target :
       {glm::vec3(0.05f, 0, 0), glm::vec3(-0.1f, 0, 0.05f), glm::vec3(0, 0, -0.11f)}) {
    const double reference = referenceAt(target);
    EXPECT_NEAR(double{show.patch(kEye, target).g} / reference, 1.0, 0.15) << target.x << " " << target.z;
  }
  for (const glm::vec3& target :
       {glm::vec3(-0.6f, 0, 0.3f), glm::vec3(0.4f, 0, -0.5f), glm::vec3(-1, 1.2f, 0.1f),
        glm::vec3(0.2f, 0.7f, -1), glm::vec3(-0.3f, 2, -0.2f)}) {
    const double reference = referenceAt(target);
    setLocalShadows(show, true);
    const double seen = double{show.patch(kEye, target).g};
    EXPECT_NEAR(seen / reference, 1.0, 0.06) << target.x << " " << target.y << " " << target.z;
    setLocalShadows(show, false);
    by_column += double{show.patch(kEye, target).g};
    found += seen;
    expected += reference;
  }
  EXPECT_NEAR(found / expected, 1.0, 0.03);
  EXPECT_NEAR(by_column / found, 1.0, 0.06) << "where nothing is hidden, both carriers bring as much";
}

}  // namespace lambent
