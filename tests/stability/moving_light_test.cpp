// Tests bodies that light and shadow each other, and lights in awkward places, from the scene through the
// baker to the frame, in pictures of a few pixels with known answers.
#include <cmath>
#include <numbers>
#include <optional>

#include <glm/ext/matrix_clip_space.hpp>
#include <glm/ext/matrix_transform.hpp>
#include <glm/geometric.hpp>
#include <gtest/gtest.h>

#include "assets/glb.hpp"
#include "assets/shapes.hpp"
#include "baker/bake/bake.hpp"
#include "baker/import/gltf.hpp"
#include "runtime/frame/frame.hpp"
#include "runtime/scene/instantiate.hpp"
#include "tests/stability/show.hpp"
#include "tests/support/gpu_context.hpp"

namespace lambent {
namespace {

using testing::add;
using testing::constantLight;
using testing::named;
using testing::Show;

using Kind = scene::LocalLightComponent::Kind;

assets::Mesh wall(float half, float cell) {  // faces +Z
  return assets::plane({-half, -half, 0}, {2 * half, 0, 0}, {0, 2 * half, 0}, cell);
}
assets::Mesh floorOf(float half, float cell) {  // faces +Y
  return assets::plane({-half, 0, half}, {2 * half, 0, 0}, {0, 0, -2 * half}, cell);
}
assets::Mesh insideOut(assets::Mesh mesh) {
  for (std::size_t i = 0; i + 2 < mesh.indices.size(); i += 3)
    std::swap(mesh.indices[i], mesh.indices[i + 1]);
  for (glm::vec3& normal : mesh.normals) normal = -normal;
  return mesh;
}

using MovingLight = testing::GpuTest;

}  // namespace

TEST_F(MovingLight, ARedBallTintsTheWhiteWallThatItComesNear) {
  assets::Scene scene = named("wall");
  add(scene, "wall", wall(1.5f, 0.1f), glm::vec3(0.8f), {0, 0, 0}, false);
  add(scene, "ball", assets::sphere(0.5f, 8), {0.8f, 0.04f, 0.04f}, {0, 0, 20}, true);
  Show show(scene, {constantLight(1.0f)}, 32);
  const glm::vec3 eye(2.5f, 0.3f, 2.0f), beside(0.7f, 0, 0), away(-1.35f, 1.35f, 0);
  const glm::vec3 alone = show.patch(eye, beside);
  EXPECT_NEAR(alone.r, 0.8f, 0.01f) << "an open wall under uniform light shows its albedo";
  EXPECT_NEAR(alone.r / alone.g, 1.0f, 0.005f);
  show.move("ball", {0, 0, 0.62f});
  const glm::vec3 tinted = show.patch(eye, beside);
  EXPECT_GT(tinted.r / tinted.g, 1.03f);
  EXPECT_LT(tinted.g, 0.96f * alone.g) << "and takes light away";
  const glm::vec3 far = show.patch(glm::vec3(-2.5f, 1.5f, 3.0f), away);
  EXPECT_LT(far.r / far.g, 1.0f + 0.5f * (tinted.r / tinted.g - 1.0f));
  show.move("ball", {0, 0, 20});
  EXPECT_LT(glm::distance(show.patch(eye, beside), alone), 0.005f) << "nothing stays behind";
}

TEST_F(MovingLight, ABodyTakesTheLightOfALampThatIsBakedIntoTheFloorItStandsOn) {
  assets::Scene scene = named("lamp");
  add(scene, "floor", floorOf(2.0f, 0.1f), glm::vec3(1.0f), {0, 0, 0}, false);
  add(scene, "body", assets::box({-0.25f, 0, -0.25f}, {0.25f, 0.5f, 0.25f}, 0.1f), glm::vec3(0.0f),
      {0.3f, 0, 9}, true);
  scene.spots = {{.name = "bulb",
                  .color = glm::vec3(1.0f),
                  .intensity_cd = 10.0f,
                  .inner_cone_deg = 60,
                  .outer_cone_deg = 80}};
  scene.nodes.push_back({.name = "bulb",
                         .mesh = -1,
                         .translation = {-0.8f, 1.4f, 0},
                         .rotation = glm::angleAxis(-0.5f * std::numbers::pi_v<float>, glm::vec3(1, 0, 0)),
                         .spot = 0});
  Show show(scene, {constantLight(0.0f)}, 1);
  // The places are behind the body, as seen from the lamp, and well in front of it. A lamp's transfer does
  // not include bodies that move, so their grids must, also if the lamp is close to the body.
  const glm::vec3 eye(1.5f, 2.0f, 0.3f), other_eye(-1.5f, 2.0f, 0.3f), behind(0.65f, 0, 0),
      before(-0.6f, 0, 0);
  const float lit = show.patch(eye, behind).g, open = show.patch(other_eye, before).g;
  EXPECT_GT(lit, 0.3f);
  for (const float height : {0.0f, 0.15f}) {
    show.move("body", {0.3f, height, 0});
    EXPECT_LT(show.patch(eye, behind).g, 0.75f * lit) << "lifted by " << height;
    EXPECT_NEAR(show.patch(other_eye, before).g, open, 0.1f * open) << "lifted by " << height;
  }
}

TEST_F(MovingLight, AnEmissiveMeshThatMovesLightsByItsFormFactor) {
  assets::Scene scene = named("panel");
  add(scene, "receiver", floorOf(0.1f, 0.1f), glm::vec3(1.0f), {0, 0, 0}, true);
  // Faces down.
  add(scene, "panel", assets::plane({-0.5f, 0, -0.5f}, {1, 0, 0}, {0, 0, 1}, 0.25f), glm::vec3(0.0f),
      {0, 40, 0}, true, glm::vec3(4.0f, 2.0f, 1.0f));
  Show show(scene, {constantLight(0.0f)}, 1);
  const glm::vec3 eye(0.9f, 0.6f, 0.9f), center(0.0f);
  EXPECT_LT(show.patch(eye, center).r, 0.01f);
  for (const float height : {1.0f, 2.0f}) {
    show.move("panel", {0, height, 0});
    const glm::vec3 lit = show.patch(eye, center);
    const float x = 0.5f / height, s = x / std::sqrt(1 + x * x);
    const float form = 4.0f / std::numbers::pi_v<float> * s * std::atan(s);
    EXPECT_NEAR(lit.r / (4.0f * form), 1.0f, 0.05f) << height;
    EXPECT_NEAR(lit.r / lit.b, 4.0f, 0.02f);
  }
}

TEST_F(MovingLight, AClosedRoomIsDarkUnderABrightSky) {
  assets::Scene scene = named("room");
  add(scene, "room", insideOut(assets::box({-1, -1, -1}, {1, 1, 1}, 0.5f)), glm::vec3(0.8f), {0, 0, 0},
      false);
  add(scene, "ball", assets::sphere(0.3f, 8), glm::vec3(0.8f), {0.2f, 0, 0}, true);
  Show show(scene, {constantLight(1e6f), *spec::parseLight("sun:30,40,5,1e8")}, 1);
  EXPECT_LT(show.patch({-0.8f, 0.2f, 0.5f}, {0.1f, 0.1f, 0.2f}).g, 1e-3f * 1e6f);
}

TEST_F(MovingLight, AStillSceneCostsNoCaptureNoProjectionAndNoShading) {
  assets::Scene scene = named("still");
  add(scene, "floor", floorOf(1.0f, 0.25f), glm::vec3(0.8f), {0, 0, 0}, false);
  add(scene, "ball", assets::sphere(0.3f, 8), glm::vec3(0.8f), {0, 0.5f, 0}, true);
  add(scene, "cube", assets::box(glm::vec3(-0.2f), glm::vec3(0.2f), 0.1f), glm::vec3(0.8f), {0.8f, 0.5f, 0},
      true);
  Show show(scene, {constantLight(1.0f)}, 4);
  show.add({.kind = Kind::Point, .strength = 5.0f}, {1, 3, 1});
  const glm::vec3 eye(2, 2, 2), target(0.0f);
  show.patch(eye, target);
  show.step(eye, target);
  show.frame->timers().finish();
  for (const gpu::PassTime& pass : show.frame->timers().latest()) {
    if (pass.name == "raster" || pass.name == "tone map") continue;
    EXPECT_EQ(pass.counters.dispatches, 0u) << pass.name;
    EXPECT_EQ(pass.counters.draws, 0u) << pass.name;
    EXPECT_EQ(pass.counters.uploaded_bytes, 0u) << pass.name;
  }
  EXPECT_EQ(show.frame->counts()["light_probes_written"], 0u);
  EXPECT_EQ(show.frame->counts()["cells_shaded"], 0u);
  show.move("ball", {0, 0.6f, 0});
  show.step(eye, target);
  EXPECT_GT(show.frame->counts()["light_probes_captured"], 0u) << "until something moves";
}

TEST_F(MovingLight, ATurningLightRelightsOnlyWhatSeesIt) {
  assets::Scene scene = named("room");
  add(scene, "room", insideOut(assets::box({-1, -1, -1}, {1, 1, 1}, 0.5f)), glm::vec3(0.8f), {0, 0, 0},
      false);
  add(scene, "ball", assets::sphere(0.3f, 8), glm::vec3(0.8f), {0.2f, 0, 0}, true);
  add(scene, "outside", assets::sphere(0.3f, 8), glm::vec3(0.8f), {30, 0, 0}, true);
  Show show(scene, {*spec::parseLight("sun:30,40,20,10")}, 1);
  const glm::vec3 eye(-0.8f, 0.2f, 0.5f), target(0.1f, 0, 0);
  show.patch(eye, target);
  for (int turn = 1; turn <= 4; ++turn) {
    show.environment.setTurn(20.0f * static_cast<float>(turn));
    for (int step = 0; step < 2; ++step) {  // the second one has the captures of the first
      show.step(eye, target);
      EXPECT_LE(show.frame->counts()["cells_shaded"], 2u) << "the ball in the room stays as it is";
    }
  }
}

TEST_F(MovingLight, MirrorsOfEmissiveLightFacingEachOtherComeToRest) {
  assets::Scene scene = named("mirrors");
  add(scene, "left", assets::plane({0, -1, 1}, {0, 0, -2}, {0, 2, 0}, 0.5f), glm::vec3(0.95f), {-0.25f, 0, 0},
      true, glm::vec3(1.0f));
  add(scene, "right", assets::plane({0, -1, -1}, {0, 0, 2}, {0, 2, 0}, 0.5f), glm::vec3(0.95f), {0.25f, 0, 0},
      true, glm::vec3(1.0f));
  Show show(scene, {constantLight(0.0f)}, 1);
  // Each bounce keeps three quarters of the light: after 25 of them a thousandth is left.
  const float seen = show.patch({0.2f, 0, 0.9f}, {-0.25f, 0, 0.2f}, /*pictures=*/3).g;
  // With one light probe a square has the light of its middle all over: B = 1 + 0.95 F B, where F = 0.831 is
  // the form factor of a square seen from the middle of the other. With patches of their own light it would
  // be 3.4.
  EXPECT_NEAR(seen, 1.0f / (1.0f - 0.95f * 0.831f), 0.05f);
}

TEST_F(MovingLight, LightsInHardPlacesStayFinite) {
  assets::Scene scene = named("hard");
  add(scene, "floor", floorOf(1.0f, 0.5f), glm::vec3(0.8f), {0, 0, 0}, false);
  add(scene, "ball", assets::sphere(0.3f, 6), glm::vec3(0.8f), {0, 0.5f, 0}, true);
  add(scene, "twin", assets::sphere(0.3f, 6), glm::vec3(0.8f), {0, 0.5f, 0}, true);  // in the very same place
  add(scene, "speck", assets::sphere(1e-6f, 1), glm::vec3(0.8f), {0.5f, 0.5f, 0}, true);
  Show show(scene, {constantLight(1.0f)}, 4);
  const glm::vec3 eye(1.5f, 1.5f, 1.5f), target(0, 0.4f, 0);
  struct Hard {
    const char* what;
    scene::LocalLightComponent light;
    glm::vec3 at;
  };
  const Hard hard[] = {
      {"at the sample point", {.kind = Kind::Sphere, .strength = 1.0f, .radius_m = 0.01f}, {0, 0.5f, 0}},
      {"a point in the body", {.kind = Kind::Point, .strength = 1.0f}, {0.05f, 0.5f, 0}},
      {"of no size", {.kind = Kind::Sphere, .strength = 1.0f, .radius_m = 0.0f}, {0, 2, 0}},
      {"of radiance 1e8", {.kind = Kind::Sphere, .strength = 1e8f, .radius_m = 0.3f}, {0, 2, 0}},
      {"around everything", {.kind = Kind::Sphere, .strength = 1.0f, .radius_m = 30.0f}, {0, 0, 0}},
      {"on the floor", {.kind = Kind::Disc, .strength = 1.0f, .radius_m = 0.2f}, {0.4f, 0, 0.4f}},
      {"a spot without a cone", {.kind = Kind::Spot, .strength = 1.0f, .outer_cone_rad = 0.0f}, {0, 2, 0}},
      {"far away", {.kind = Kind::Point, .strength = 1e9f}, {0, 1e7f, 0}}};
  for (const Hard& one : hard) {
    SCOPED_TRACE(one.what);
    show.add(one.light, one.at);
    const glm::vec3 seen = show.patch(eye, target);
    EXPECT_GE(seen.g, 0.0f);
  }
  for (auto [entity, transform] : show.world.registry().view<const scene::Transform>())
    if (show.world.registry().has<scene::Name>(entity) &&
        show.world.registry().get<scene::Name>(entity).value == "twin")
      show.world.registry().edit<scene::Transform>(entity).scale = glm::vec3(0.0f);
  SCOPED_TRACE("a body shrunk to nothing");
  show.patch(eye, target);
}

}  // namespace lambent
